protocol side-of-percentile "A percentile chosen by the curve or by the measurement"
  axis  distance in m
  time  time in s

parameter rule "What decides"
  default  measured_side
  one of   measured_side, curve

place wheelset
  members  1, 2

place side
  members  R, L
  alias    outer is L when direction is right, R when direction is left

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

section cant_deficiency "Cant deficiency"
  in  mm

section speed "Speed"
  in  km/h

channel Y "Guiding force"
  in      kN
  at      each wheelset and side
  column  "Y_{wheelset}{side}"

define by_curve "The side of the outer wheel"
  is  |p0.15| when direction is right, |p99.85| when direction is left, otherwise larger of |p0.15|, |p99.85|

define by_measurement "The side that is larger in the measurement, for both"
  is  |p99.85| when |measured(p99.85)| >= |measured(p0.15)|, otherwise |p0.15|

zone 1 "Straight track"
  where             direction is straight
  minimum sections  1

zone 2 "Curves"
  where             direction is not straight
  minimum sections  2

sections
  zone  zone

quantity extreme "Maximum"
  of          Y at wheelset 1
  value       by_measurement when rule is measured_side, otherwise by_curve
  difference  magnitudes
  limit       std 5 kN

quantity extreme_by_curve "Maximum, by the curve"
  of          Y at wheelset 1
  value       by_curve
  difference  magnitudes
  limit       std 5 kN
