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

parameter share
  default  shape

signal sum "Sum"
  is  Y at wheelset 1 side R + Z at wheelset 1 side L
  at  each weelset

quantity a
  of          Yy at wheelset 1
  filter      LP2O
  value       median
  difference  orientd
  limit       sdt 3 kN
  limit       std 3 kM

quantity b
  of          Y at wheelset 3 and seide R
  filter      lowpass 20 Hz, order 4
  value       medain of Y at wheelset 1 side R
  difference  signed
  limit       std 3 kN for zone 7
  where       direktion is left

quantity c
  of          ay at running gaer I
  filter      low-pass 20 Hz, ordre 4
  value       sqr(p99)
  difference  signed
  limit       std 3 m/s^2 only when category is fright

quantity d
  of      ay at wheelset 1
  metric  sprague-gears magnitude
  limit   each vehicle.Q1

verdict
  standard deviation  n-2
