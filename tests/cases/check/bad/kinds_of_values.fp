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

channel wide "A channel"
  in      mm
  at      each side
  column  "wide"

channel tall "A channel"
  in      mm
  column  "tall_{side}"

place corner
  members  A-1, B, B
  alias    C is D when radius > 3 m
  alias    B is B when radius

signal mixed "Two records"
  is  Y at wheelset 1 side R * curvature

signal open "Which wheel is not said"
  is  Y at wheelset 1
  in  kN

signal powers "A power"
  is  (Y at wheelset 1 side R)^9 * (Y at wheelset 1 side R)^9

define high "A power"
  is  ((1 kN)^9)^9

quantity functions
  of          Y at wheelset 1
  filter      low-pass 20 Hz, order 4, causal, zero-phase, order 2
  value       sqr(p99)
  difference  signed
  where       sqrt(radius, radius) > 3

quantity sides
  of          Y at wheelset 1
  value       measured(3, 4)
  difference  measured(p99) - simulated
  limit       std 3 kN

quantity words
  of          Y at wheelset 1
  value       median * direction
  difference  signed
  where       direction is 3 m or direction > 2
  limit       std 3 kN

quantity reducers
  of          Y at wheelset 1
  value       medain of curvature
  difference  signed
  limit       std range of curvature

quantity difference
  of          Y at wheelset 1
  value       median
  difference  signal
  limit       std 3 m
