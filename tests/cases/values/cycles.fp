protocol cycles "Numbers of cycles"
  axis  distance in m
  time  time in s

channel Q "Vertical wheel force"
  in      kN
  column  "Q_1R"

signal ranges "The ranges of its cycles"
  is  cycle_ranges(Q)
  in  kN

quantity number "Cycles above a range"
  of     Q
  from   measured
  value  count where ranges > 4 kN
  limit  each 1e6

quantity damage "Sum of powers"
  of     Q
  from   measured
  value  total of (ranges / (1 kN))^5
  limit  each 1e12

quantity large "A percentile of the half cycles"
  of     Q
  from   measured
  value  p95 of ranges / (1 kN) + maximum of ranges / (1 kN)
  limit  each 1e6

quantity both "Damage of both sides"
  of      Q
  metric  total of cycle_ranges(simulated)^5 / total of cycle_ranges(measured)^5
  limit   each 1e6

verdict
  validated  when every limit holds
