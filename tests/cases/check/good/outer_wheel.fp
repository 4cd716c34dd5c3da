protocol outer-wheel "The outer wheel, whichever it is"
  axis  distance in m
  time  time in s

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

signal outer_force "Guiding force of the outer wheel, towards the outside"
  is     Y at side outer when direction is left,
         -(Y at side outer) when direction is right,
         otherwise Y at side R
  at     each wheelset
  in     kN
  named  "Y_{wheelset}outer"

zone 1 "Straight track"
  where             direction is straight
  minimum sections  1

zone 2 "Curves"
  where             direction is not straight
  minimum sections  2

sections
  zone  zone

quantity leading_outer "Leading outer wheel"
  of          Y at wheelset 1 and side outer
  value       median
  difference  oriented
  limit       std 5 kN
  where       direction is not straight

quantity towards_outside "The same, positive towards the outside"
  of          outer_force at wheelset 1
  value       median
  difference  signed
  limit       std 5 kN
  where       direction is not straight
