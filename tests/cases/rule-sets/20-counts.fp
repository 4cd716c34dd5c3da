protocol counts "Level crossings and class shares"
  extends  "base.fp"

parameter level "Level of the wheel force"
  default  60 kN

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
