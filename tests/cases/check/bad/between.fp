protocol between "Limits between two edges that cannot be meant"
  extends  en14363-2016-annex-t

quantity Y_max
  limit  median between 3 kN and 2 kN
  limit  each between 1 kN and 10 kN
  limit  p95 between -1 m and 10 kN
  limit  p90 limit of median
  limit  range between 1 kN
  limit  p80 at most between 1 kN and 2 kN
  limit  p75 between 5 kN and 9 kN or 3 kN

quantity Y_assessed "Nothing is between the edges"
  from   measured
  of     Y at wheelset 1
  value  p99.85
  limit  mean between 3 kN and 2 kN
