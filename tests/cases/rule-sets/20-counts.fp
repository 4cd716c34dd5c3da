protocol counts "Level crossings and class shares"
  extends  "base.fp"

parameter level "Level of the wheel force"
  default  60 kN

signal above "1 above the level, 0 below"
  is  1 when Q through LP20 > level, otherwise 0
  at  each wheelset and side

# Every crossing is a change of 1 over one step; the magnitude of its slope integrates to 1.
signal crossings "Number of crossings of the level since the start of the record"
  is  integral(|derivative(above)|)
  at  each wheelset and side

quantity Q_crossings "Crossings of the level per metre"
  of          crossings at wheelset 1
  value       (last - first) / length
  difference  signed
  limit       std 0.1 1/m

quantity Q_class_{k} "Share of samples in the class from {lo} to {hi}"
  for each  k, lo, hi in (1, 40 kN, 50 kN), (2, 50 kN, 60 kN), (3, 60 kN, 70 kN)
  of        Q at wheelset 1
  filter    LP20
  metric    (share where {lo} <= simulated < {hi}) - (share where {lo} <= measured < {hi})
  limit     p90 10 %
