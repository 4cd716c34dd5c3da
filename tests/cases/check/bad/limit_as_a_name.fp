protocol limit-as-a-name "A parameter called limit"
  extends  en14363-2016-annex-t

parameter limit "A name that reads as the word"
  default  0.5

quantity Y_max
  limit  peak limit of std
