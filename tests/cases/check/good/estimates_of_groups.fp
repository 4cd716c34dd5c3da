protocol estimates-of-groups "Weights, numbers of several groups, minimum counts of groups"
  extends  en14363-2016-annex-t

section site_class "Class of the track"
  one of   a, b
  default  a

estimate zone_mean "Mean of the means of the zones"
  is  mean of (mean for each zone)

estimate safety "One-dimensional estimate"
  is  mean weighted by length + 3 * std weighted by length

verdict
  minimum pairs  20
  minimum pairs  2 for each zone and site_class

quantity Y_max
  minimum pairs  24
  minimum pairs  3 for each zone and wheelset where direction is not straight
  limit  mean weighted by length 9 kN
  limit  p95 weighted by (length * speed) 9 kN for each zone
  limit  upper 95 % of mean weighted by length 9 kN
  limit  upper 95 % of p80 weighted by length by bootstrap 9 kN
  limit  (share weighted by length where |value| <= 9 kN) at least 0.8
  limit  (share weighted by length of sections where radius < 500 m) at least 0.1
  limit  (mean of radius weighted by length) at least 300 m
  limit  zone_mean 9 kN
  limit  safety 20 kN for each zone
  limit  (maximum of (safety for each zone and wheelset)) 20 kN
  limit  (std of (mean for each site)) 9 kN for each wheelset

quantity ay_rms
  limit  median 1 m/s^2 for each running gear
  limit  p80 1 m/s^2 for each zone and running gears where speed > 60 km/h

remove
  quantity  YQ_max
