protocol reports "Estimates without a limit"
  extends  en14363-2016-annex-t

parameter shown "Statistic that is shown"
  default  maximum
  one of   maximum, p95

parameter steepness "A number from memory"
  default      3
  unconfirmed  "From memory."

estimate total_length "Total length"
  is  total of length

estimate safety "One-dimensional estimate"
  is  mean + steepness * std

sections
  report  total_length in km for each zone
  report  mean of radius for each zone where direction is not straight
  report  share of sections where direction is right for zones 2, 3, 4
  report  share weighted by length of sections where zone is 4
  report  mean of speed

quantity Y_max
  report  shown for each zone and wheelset
  report  mean + 3 * std in N
  report  safety for each zone
  report  upper 95 % of mean
  report  total_length for each zone
  report  n for each zone

quantity Y_phase "Guiding force, phase error"
  of      Y at wheelset 1
  filter  LP20
  metric  sprague-geers phase
  report  p80 for each zone
