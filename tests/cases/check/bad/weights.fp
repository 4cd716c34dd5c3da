protocol weights "Weights and groups that cannot be meant"
  extends  en14363-2016-annex-t

estimate maximum_1 "One-dimensional estimate"
  is  mean + 3 * std

estimate nothing "Nothing of the values of a zone"
  is  mean of (3 * Q0 for each zone)

quantity Y_max
  limit  maximum weighted by length 9 kN
  limit  maximum_1 weighted by length 9 kN
  limit  (n weighted by length) 9
  limit  ((mean + 3 * std) weighted by length) 9 kN
  limit  mean weighted by direction 9 kN
  limit  std weighted by Y 9 kN
  limit  p80 weighted by (0 * length) 9 kN
  limit  p81 weighted by (-2) 9 kN
  limit  (total of length weighted by radius) at least 9 m
  limit  p82 mean weighted by length
  limit  (mean for each zone) 9 kN
  limit  (mean + 3 * (std for each zone and wheelset)) 9 kN
  limit  (mean of (mean for each whelset)) 9 kN
  limit  (men of (mean for each zone)) 9 kN
  limit  (mean of (mean for each speed)) 9 kN
  limit  nothing 9 kN
  limit  p83 mean of (mean for each zone)

quantity Q_max
  value  mean weighted by length
  where  mean of (speed for each zone) > 3 km/h
