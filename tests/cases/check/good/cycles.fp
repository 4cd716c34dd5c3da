protocol cycles "Cycles of signals"
  axis  distance in m
  time  time in s

channel Q "Wheel force"
  in      kN
  column  "Q_1R"

quantity number "How many, beyond a share of the largest"
  of     Q
  from   measured
  value  count where cycle_ranges(Q) > 0.2 * maximum of cycle_ranges(Q)
  limit  each 100

quantity damage "A power of the ranges"
  of     Q
  from   measured
  value  total of (cycle_ranges(Q through low-pass 20 Hz) / (10 kN))^5
  limit  each 1e6

quantity large "A percentile, and a mean of some"
  of     Q
  from   measured
  value  p95 of cycle_ranges(Q) + mean of (cycle_ranges(Q) when cycle_ranges(Q) > 1 kN)
  limit  each 100 kN

quantity both "Of both sides"
  of      Q
  metric  total of cycle_ranges(simulated)^2 / total of cycle_ranges(measured)^2
  limit   each at most 2

verdict
  validated  when every limit holds
