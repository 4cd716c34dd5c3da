protocol weights "Values with weights, and numbers of several groups"
  extends  en14363-2016-annex-t

remove
  quantity  every

estimate zone_mean "Mean of the means of the zones"
  is  mean of (mean for each zone)

quantity Q "Vertical wheel force"
  from    measured
  of      Q at wheelsets 1, 2, 3, 4 and side outer when direction is not straight
  of      Q at wheelsets 1, 2, 3, 4 when direction is straight
  filter  LP20
  value   p99.85
  limit   mean weighted by length 500 kN
  limit   std weighted by (length * speed) 500 kN
  limit   rms weighted by length 500 kN
  limit   median weighted by length 500 kN
  limit   p80 weighted by length 500 kN
  limit   upper 95 % of mean weighted by length 500 kN
  limit   (share weighted by length where value <= 60 kN) at least 0.001
  limit   (mean of speed weighted by length) at least 1 m/s
  limit   (mean of (mean for each section)) 500 kN
  limit   (std of (mean weighted by length for each wheelset)) 500 kN
  limit   (maximum of (mean + 3 * std for each wheelset and zone)) 500 kN
  limit   zone_mean 500 kN
  limit   upper 95 % of zone_mean 500 kN
  limit   upper 95 % of mean weighted by length by bootstrap 500 kN

quantity Q_of_zones "Vertical wheel force, zone by zone"
  from    measured
  of      Q at wheelsets 1, 2, 3, 4 and side outer when direction is not straight
  of      Q at wheelsets 1, 2, 3, 4 when direction is straight
  filter  LP20
  value   p99.85
  limit   mean weighted by length 500 kN for each zone
  limit   std weighted by (length * speed) 500 kN for each zone
  limit   rms weighted by length 500 kN for each zone
  limit   median weighted by length 500 kN for each zone
  limit   p80 weighted by length 500 kN for each zone
  limit   upper 95 % of mean weighted by length 500 kN for each zone
  limit   (share weighted by length where value <= 60 kN) at least 0.001 for each zone
  limit   (mean of speed weighted by length) at least 1 m/s for each zone
  limit   (mean of (mean for each section)) 500 kN for each zone
  limit   (std of (mean weighted by length for each wheelset)) 500 kN for each zone
  limit   (maximum of (mean + 3 * std for each wheelset and zone)) 500 kN for each zone
