protocol small "A protocol for trials"
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

filter WINDOW_FIRST "A window before the filter"
  step  sliding mean 2 m every 0.5 m
  step  low-pass 20 Hz, order 4

filter SPATIAL "Cycles per length"
  step  low-pass 0.33 1/m, order 2

quantity x
  of          Y at wheelset 1
  filter      SPATIAL
  value       median
  difference  signed
  limit       std 3 kN

quantity y
  of          Y at wheelset 1
  filter      resample every 0.25 m, then low-pass 20 Hz
  value       median
  difference  signed
  limit       std 3 kN

quantity z
  of      Y at wheelset 1
  filter  LP20, then sliding mean 2 m every 0.5 m
  metric  correlation
  limit   minimum at least 0.8

signal inside "A window in a signal"
  is  Y through RESAMPLED
  at  each wheelset and side

filter RESAMPLED "Resampled"
  step  resample every 0.25 m
