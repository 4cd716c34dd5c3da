protocol verdict-in-draws "The verdict in draws of the sections"
  extends  en14363-2016-annex-t

verdict
  validated  when every limit holds in 95 % of draws
