protocol transfer "Transfer functions"
  axis  distance in m
  time  time in s

place wheelset
  members  1, 2

place side
  members  R, L
  alias    outer is L when direction is right, R when direction is left

place running_gear
  members  I, II

vehicle category "Vehicle category"
  one of  passenger, freight

vehicle Q0 "Static wheel force"
  in  kN

section zone "Test zone"
  one of  zones

section radius "Curve radius"
  in  m

section direction "Direction"
  one of  right, left, straight

channel Y "Guiding force"
  in      kN
  at      each wheelset and side
  column  "Y_{wheelset}{side}"

channel ay "Lateral acceleration"
  in  m/s^2
  at  each running_gear

channel curvature "Curvature"
  in      1/m
  record  track

filter LP20 "Low-pass filter"
  step  low-pass 20 Hz, order 4

zone 1 "Straight track"
  where  direction is straight

zone 2 "Curves"
  where  direction is not straight

sections
  zone  zone

quantity no_quality
  of          Y at wheelset 1
  filter      transfer function poles 5 Hz
  value       median
  difference  signed
  limit       std 3 kN

quantity pole_at_zero
  of          Y at wheelset 1
  filter      transfer function pole 0 Hz
  value       median
  difference  signed
  limit       std 3 kN

quantity quality_of_nothing
  of          Y at wheelset 1
  filter      transfer function poles 5 Hz quality 0
  value       median
  difference  signed
  limit       std 3 kN

quantity quality_at_zero
  of          Y at wheelset 1
  filter      transfer function poles 5 Hz quality 0.7 zeros 0 Hz quality 0.7
  value       median
  difference  signed
  limit       std 3 kN

quantity mixed
  of          Y at wheelset 1
  filter      transfer function pole 5 Hz zero (1 / (3 m))
  value       median
  difference  signed
  limit       std 3 kN

quantity no_gain
  of          Y at wheelset 1
  filter      transfer function pole 5 Hz, gain 0
  value       median
  difference  signed
  limit       std 3 kN

quantity both
  of          Y at wheelset 1
  filter      transfer function pole 5 Hz, causal, zero-phase
  value       median
  difference  signed
  limit       std 3 kN

quantity no_order
  of          Y at wheelset 1
  filter      transfer function pole 5 Hz, order 4
  value       median
  difference  signed
  limit       std 3 kN

quantity after_window
  of          Y at wheelset 1
  filter      sliding mean 2 m every 0.5 m, then transfer function pole 5 Hz
  value       median
  difference  signed
  limit       std 3 kN

quantity per_length
  of          Y at wheelset 1
  filter      transfer function pole (1 / (3 m))
  value       median
  difference  signed
  limit       std 3 kN

quantity wrong_unit
  of          Y at wheelset 1
  filter      transfer function pole 5 Hz, gain 2 s
  in          kN
  value       median
  difference  signed
  limit       std 3 kN
