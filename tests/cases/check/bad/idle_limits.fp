protocol idle-limits "Limits that hold or fail whatever the values are"
  extends  en14363-2016-annex-t

quantity Y_max
  limit  (share where value > 5 kN) 5
  limit  (share where value <= 5 kN) at least 80 for each zone
  limit  (upper 95 % of (share where value > 6 kN)) 1.5
  limit  (share where value <= 7 kN weighted by length) at least 0.8
  limit  p80 1.5 * p50 of Y_max
  limit  (mean + 3 * std) 9 kN for each zone
  limit  (|mean| + 2 * std) 9 kN
  limit  (3 * std weighted by length + mean weighted by length) 9 kN
  limit  upper 5 % of std 9 kN
  limit  (prediction over speed at 100 km/h, confidence 1 %) 9 kN
  limit  (p50 + rms) 9 kN for each zone and zone
  limit  p95 9 kN for zones 3, 3
  limit  p90 9 kN for each direction and direction
  limit  p85 weighted by lenght 9 kN
  limit  (mean of (mean for each bogie)) 9 kN

quantity Q_max
  compare  codes with measured
  limit    p85 weighted by lenght 9 kN

verdict
  words  not validated, validated

quantity Q_qst
  difference  |measured| - |measured|

quantity ay_max
  value  measured(p99.85)
