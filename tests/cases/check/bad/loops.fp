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

parameter a
  default  2 * b

parameter b
  default  a + 1

define c "Made of itself"
  is  d + 1 kN

define d "By way of"
  is  c * 2

signal s "A signal of itself"
  is  t * 2
  at  each wheelset

signal t "The other one"
  is  s / 2
  at  each wheelset

filter F "A filter of itself"
  step  G

filter G "The other one"
  step  low-pass 20 Hz, order 4, then F

quantity x
  of          s at wheelset 1
  filter      F
  value       median
  difference  signed
  limit       std c

quantity y
  of          Y at wheelset 1
  value       median
  difference  signed
  limit       std 2 of limit of mean
  limit       mean 3 of limit of rms
  limit       rms 4 of limit of std
  limit       p95 3 kN
