protocol verdict-of-none "A verdict on nothing"
  axis  distance in m
  time  time in s

place wheelset
  members  1, 2

place side
  members  R, L

section zone "Test zone"
  one of  zones

section direction "Direction"
  one of  right, left, straight

channel Y "Guiding force"
  in      kN
  at      each wheelset and side
  column  "Y_{wheelset}{side}"

zone 1 "Straight track"
  where             direction is straight
  minimum sections  1

zone 2 "Curves"
  where             direction is not straight
  minimum sections  2

sections
  zone  zone

quantity left "Left wheel"
  of          Y at wheelset 1 and side L
  value       median
  difference  signed
  limit       mean 1 kN

verdict measured
  of     measured
  holds  when every limit holds
