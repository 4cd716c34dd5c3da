protocol field-beside "Fields in the line of their block"
  extends  en14363-2016-annex-t

remove every plausibility

sections zone zone
