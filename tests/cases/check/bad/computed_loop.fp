protocol computed-loop "Section data that need each other"
  extends  en14363-2016-annex-t

section a "One"
  in  m
  is  b + 1 m

section b "Other"
  in  m
  is  a - 1 m

section own "Itself"
  in  m
  is  own / 2
