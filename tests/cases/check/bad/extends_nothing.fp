protocol variant "A variant of what is not there"
  extends  en14363-2016-annex-tt

quantity ay_max
  limit  std 0.3 m/s^2
