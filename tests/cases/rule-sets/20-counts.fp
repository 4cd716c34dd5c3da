protocol counts "Level crossings, class shares and rainflow cycles"
  extends  "base.fp"

parameter level "Level of the wheel force"
  default  60 kN

parameter exponent "Exponent of the line of Woehler"
  default  5

quantity Q_crossings "Upward crossings of the level per metre"
  of          Q at wheelset 1
  value       (crossings where Q through LP20 > level) / length
  difference  signed
  limit       std 0.1 1/m

quantity Q_class_{k} "Share of samples in the class from {lo} to {hi}"
  for each  k, lo, hi in (1, 40 kN, 50 kN), (2, 50 kN, 60 kN), (3, 60 kN, 70 kN)
  of        Q at wheelset 1
  filter    LP20
  metric    (share where {lo} <= simulated < {hi}) - (share where {lo} <= measured < {hi})
  limit     p90 10 %

quantity Q_cycles "Cycles with a range above 10 kN per metre"
  of          Q at wheelset 1
  value       (count where cycle_ranges(Q through LP20) > 10 kN) / length
  difference  signed
  limit       std 0.1 1/m

quantity Q_range_{k} "Cycles with ranges from {lo} to {hi} per metre"
  for each    k, lo, hi in (1, 5 kN, 10 kN), (2, 10 kN, 20 kN), (3, 20 kN, 40 kN)
  of          Q at wheelset 1
  value       (count where {lo} <= cycle_ranges(Q through LP20) < {hi}) / length
  difference  signed
  limit       std 0.1 1/m

quantity Q_damage "Damage by the rule of Palmgren and Miner, simulated over measured"
  of      Q at wheelset 1
  filter  LP20
  metric  total of (cycle_ranges(simulated) / (1 kN))^exponent / total of (cycle_ranges(measured) / (1 kN))^exponent
  limit   each at most 2
  limit   each at least 0.5

quantity Q_equivalent "Range of a million cycles of the same damage in 100 km"
  of          Q at wheelset 1
  value       (total of cycle_ranges(Q through LP20)^exponent * (100 km / length) / 1e6)^(1 / exponent)
  difference  (simulated - measured) / measured
  limit       p90 10 %
