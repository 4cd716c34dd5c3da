protocol signal-operations "Signals along the axis, wrong"
  extends  sprague-geers

signal by_time
  is  shifted(Y, 0.1 s)
  at  each wheelset and side

signal no_distance
  is  shifted(Y)
  at  each wheelset and side

signal over_distance
  is  derivative(Y, distance)
  at  each wheelset and side

signal kind
  is  derivative(Y)
  at  each wheelset and side
  in  kN/s

quantity mean_over
  of          Y at wheelset 1
  value       mean over Q
  difference  signed
  limit       std 1 kN

quantity range_over
  of          Y at wheelset 1
  value       range of Y over Q
  difference  signed
  limit       std 1 kN

quantity number_over
  of          Y at wheelset 1
  value       (rms / 2) over Q
  difference  signed
  limit       std 1 kN

quantity slope_unit
  of          Y at wheelset 1
  value       slope over ay at running_gear I
  difference  signed
  limit       std 1 kN

quantity signal_for_number
  of          Y at wheelset 1
  value       derivative(Y)
  difference  signed
  limit       std 1 kN
