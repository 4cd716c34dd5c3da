protocol several "A word in the wrong place"
  extends  en14363-2016-annex-t

remove
  every quantity
