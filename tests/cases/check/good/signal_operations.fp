protocol signal-operations "Signals moved, derived, integrated; slopes over signals"
  extends  sprague-geers

remove
  quantity  every

parameter wheelbase "Distance of the wheelsets of one running gear"
  default  2.5 m

signal Y_slope "Slope of the guiding force over the distance"
  is  derivative(Y)
  at  each wheelset and side
  in  kN/m

signal jerk "Lateral jerk"
  is  derivative(ay through LP20, time)
  at  each running gear
  in  m/s^3

signal impulse "Integral of the guiding force over the distance"
  is  integral(Y)
  at  each wheelset and side
  in  kN*m

signal Y_12 "Guiding forces of wheelsets 1 and 2 at the same place of the track"
  is  shifted(Y at wheelset 1, wheelbase) + Y at wheelset 2
  at  each side
  in  kN

quantity slope_of_Y
  of          Y_slope at wheelset 1
  filter      LP20
  value       p99.85
  difference  signed
  limit       std 10 kN/m

quantity jerk_rms
  of          jerk
  value       rms
  difference  signed
  limit       std 1 m/s^3

quantity impulse_of_section
  of          impulse at wheelset 1
  value       last - first
  difference  signed
  limit       std 200 kN*m

quantity sum_at_place
  of          Y_12
  filter      LP20
  value       p99.85
  difference  signed
  limit       std 10 kN

quantity ratio_by_slope "Slope of the guiding force over the wheel force, both filtered"
  of          Y at wheelset 1
  filter      LP20
  value       slope over Q
  difference  signed
  limit       std 0.5

quantity ratio_named "The same of named signals, filtered each"
  of          ay at running gear I
  value       slope of (Y at wheelset 1 side R through LP20) over Q at wheelset 1 side R through LP20
  difference  signed
  limit       std 0.5
