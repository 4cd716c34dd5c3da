protocol limits-by-speed "Limits that depend on the speed of the section"
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

filter LP20 "Low-pass filter"
  step  low-pass 20 Hz, order 4

zone 1 "Straight track"
  where             direction is straight
  minimum sections  1

zone 2 "Curves"
  where             direction is not straight
  minimum sections  2

sections
  zone  zone

quantity each_section "Every section by itself"
  of          Y at wheelset 1
  filter      LP20
  value       median
  difference  signed
  limit       each 3 kN when speed <= 80 km/h,
              4 kN when speed <= 160 km/h,
              otherwise 5 kN, times 1.5 when zone is 2

quantity by_class "Statistics of classes of sections"
  of          Y at wheelset 1
  filter      LP20
  value       median
  difference  signed
  limit       std 3 kN for sections where speed <= 80 km/h
  limit       std 4 kN for sections where speed > 80 km/h
  limit       mean 2/3 of limit of std for sections where speed <= 80 km/h
