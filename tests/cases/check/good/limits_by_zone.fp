protocol limits-by-zone "A table of limits by zone"
  axis  distance in m
  time  time in s

parameter share "Limit of the mean as a share of that of the standard deviation"
  default  2/3

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

zone 1 "Straight track"
  where             direction is straight
  minimum sections  1

zone 2 "Curves"
  where             direction is not straight
  minimum sections  2

sections
  zone  zone

quantity table "One line of limits for all zones"
  of          Y at wheelset 1
  value       median
  difference  signed
  limit       std 5 kN when zone is 1, otherwise 7 kN for each zone
  limit       mean share of limit of std for each zone
  limit       p95 10 kN for zone 2

quantity by_condition "Limits that exclude each other by the vehicle"
  of          Y at wheelset 1
  value       median
  difference  signed
  limit       std 5 kN only when category is freight
  limit       std 4 kN only when category is passenger and Q0 >= 50 kN
  limit       std 3 kN only when category is passenger and Q0 < 50 kN
