protocol small "A small protocol, every kind of node"
  axis  distance in m
  time  time in s

place side
  members  R, L
  alias    outer is L when direction is right, R when direction is left

section zone "Test zone"
  one of  zones

section direction "Direction"
  one of  right, left

channel Y "Guiding force"
  in      kN
  at      each side
  column  "Y <&> \"{side}\" \\"

channel Q "Wheel force"
  in  kN
  at  each side

channel curvature "Curvature"
  in      1/m
  record  track

signal sum "Sum"
  is  (Y at side R through LP20) + (Y at side L through LP20)
  in  kN

signal ratio "Ratio"
  is  -hypot(Y, 2 * Q) / Q^2 * 3 kN
  at  each side

filter LP20 "Low-pass filter"
  step  low-pass 20 Hz, order 4

zone 1 "All track"

check full_curve "Full curve"
  require  range of curvature <= 2 % * |mean of curvature|

sections
  zone  zone

quantity maximum "Maximum"
  of          Y
  filter      LP20
  value       larger of |p0.15|, |p99.85|
  difference  magnitudes
  limit       std 3 kN
  limit       mean 2/3 of limit of std

quantity outer "Outer wheel"
  of          Y at side outer
  filter      LP20, then sliding mean 2 m every 0.5 m
  value       median
  difference  signed
  limit       std 3 kN for each zone

quantity together "Sum"
  of      sum
  metric  correlation
  limit   minimum at least 0.8

quantity of_ratio "Ratio"
  of          ratio
  value       rms
  difference  signed
  limit       each 3
