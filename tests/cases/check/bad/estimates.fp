protocol estimates "Estimates that cannot be meant"
  extends  en14363-2016-annex-t

estimate nothing "Nothing of the values"
  is  3 * Q0

estimate outlook "Without a confidence"
  is  prediction over cant_deficiency at 100 mm

estimate two_for_one "Two regressors at one value"
  is  regression over cant_deficiency, speed at 100 mm

estimate wrong_unit "Read at a length in place of a speed"
  is  regression over speed at 100 mm

estimate certain "A confidence of 100 %"
  is  upper 100 % of mean

estimate single "Every value by itself is no number"
  is  mean + each

estimate misspelt "A statistic that is none"
  is  upper 95 % of stdd

quantity Y_max
  limit  nothing 9 kN
  limit  outlook 9 kN
  limit  two_for_one 9 kN
  limit  wrong_unit 9 kN
  limit  certain 9 kN
  limit  single 9 kN
  limit  misspelt 9 kN
  limit  p95 range of curvature
  limit  p90 9 kN for each whelset
  limit  p80 9 kN for each radius
  limit  (upper 95 % of each) 9 kN
  limit  p70 upper 95 % of std
  limit  (3 * median of radius) 9 kN
  limit  (totl of length) at least 500 m
  limit  (upper 95 % of (upper 90 % of p80)) 9 kN
  limit  (upper 99.9 % of p70) 9 kN
  limit  (upper 95 % of (share where value <= 9 kN)) at least 9 kN

quantity Q_max
  from  measured

quantity assessed "Records that are none"
  of     Y at wheelset 1
  from   mesured
  value  p99.85
  limit  p95 9 kN

quantity compared "A comparison that is none"
  of          Y at wheelset 1
  compare     simulated with best of simulated
  value       p99.85
  difference  signed
  limit       p95 9 kN

quantity of_two_kinds "Signals and values of two kinds"
  of     Y at wheelset 1
  of     ay
  from   measured
  value  p99.85
  limit  p95 9 kN

quantity of_two_values "Values of two kinds"
  of     Y at wheelset 1
  from   measured
  value  p99.85
  value  slope
  limit  p95 9 kN

quantity other_record "The record that is not read"
  of     Y at wheelset 1
  from   measured
  value  mean - simulated(mean)
  limit  p95 9 kN

quantity twice "One position by two ways"
  of     Y at wheelset 1
  of     Y at wheelsets 1, 3 when direction is right
  from   measured
  value  median
  limit  p95 9 kN

quantity doubled_value "One value in two lines"
  of     Y at wheelset 1
  from   measured
  value  median
  value  median
  limit  p95 9 kN

estimate upper "A word of estimates"
  is  mean

estimate unused "Unknown names are told all the same"
  is  mean + nonsense
