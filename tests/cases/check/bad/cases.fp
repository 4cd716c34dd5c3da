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

define table "A case is missing"
  is  3 kN when category is freight, 4 m when Q0 > 100 kN

define gap "Nothing where the track is straight"
  is  3 kN when direction is right, 4 kN when direction is left

quantity x
  of          Y at wheelset 1
  value       p1 when direction is right, p99 when direction is left
  difference  signed
  limit       std 3 kN when category is freight, 4 kN when category is passenger
  limit       mean 3 kN when Q0 > 100 kN

quantity outer
  of          Y at wheelset 1 and side outer
  value       median
  difference  signed
  limit       std 3 kN
