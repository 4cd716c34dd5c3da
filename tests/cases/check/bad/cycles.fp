protocol cycles "What cycles do not have"
  axis  distance in m
  time  time in s

channel Q "Wheel force"
  in      kN
  column  "Q_1R"

channel Y "Guiding force"
  in      kN
  column  "Y_1R"

signal ranges "Cycles"
  is  cycle_ranges(Q)

signal filtered "No filter"
  is  ranges through low-pass 10 Hz

signal again "No cycles"
  is  cycle_ranges(ranges)

signal mixed "They are no samples"
  is  ranges / Q

signal two "Nor those of another signal"
  is  ranges / cycle_ranges(Y)

signal lines "Nor lines"
  is  ranges / spectrum(Q, 4 s)

signal number "A number has none"
  is  cycle_ranges(4 kN)

signal many "One signal"
  is  cycle_ranges(Q, Y)

quantity ordered "They have no order"
  of     Q
  from   measured
  value  longest run where ranges > 1 kN
  limit  each 1

quantity crossed "So nothing crosses"
  of     Q
  from   measured
  value  crossings where ranges > 1 kN
  limit  each 1

quantity begins "And none is the first"
  of     Q
  from   measured
  value  first of ranges
  limit  each 1 kN

quantity samples "The number of samples depends on the rate"
  of     Q
  from   measured
  value  count where Q > 60 kN
  limit  each 1

quantity sum "And so does their total"
  of     Q
  from   measured
  value  total of Q
  limit  each 1 kN

verdict
  validated  when every limit holds
