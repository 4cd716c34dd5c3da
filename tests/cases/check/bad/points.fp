protocol points "Options of metrics"
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

quantity no_such
  of      Y at wheelset 1
  metric  correlation, 50 points
  limit   minimum at least 0.5

quantity half
  of      Y at wheelset 1
  metric  matching probability, 2.5 points
  limit   minimum at least 0.5

quantity one
  of      Y at wheelset 1
  metric  matching probability, 1 points
  limit   minimum at least 0.5

quantity misspelt
  of      Y at wheelset 1
  metric  matching probability, 50 pionts
  limit   minimum at least 0.5

quantity twice
  of      Y at wheelset 1
  metric  area between distributions, 50 points, points 20
  limit   minimum at least 0.5

quantity unit
  of      Y at wheelset 1
  metric  area between distributions, 50 m points
  limit   minimum at least 0.5
