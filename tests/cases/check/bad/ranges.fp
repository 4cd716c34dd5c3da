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

parameter low
  default  70 Hz
  range    5 Hz to 60 Hz

parameter choice
  default  three
  one of   one, two

parameter units
  default  3 kN
  range    1 m to 5 m

vehicle load "Load"
  in       kN
  default  3 m

vehicle brake "Brake"
  one of   disc, block
  default  drum

filter BAND "Upside down"
  step  band-pass 10 Hz to 4 Hz, order 4

filter ORDER "Half an order"
  step  low-pass 20 Hz, order 2.5

quantity x
  of               Y at wheelset 1
  value            p101
  difference       signed
  limit            std 0 kN
  limit            p105 3 kN
  minimum signals  2.5
  minimum pairs    3 m

quantity y
  of          Y at wheelset 1
  value       median
  difference  signed
  limit       std 3 kN / 0

verdict
  validated  when at least 3.5 quantities hold
