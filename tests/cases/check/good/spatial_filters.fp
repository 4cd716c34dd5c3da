protocol spatial-filters "Filters in cycles per length"
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

filter LONG "Wavelengths of 3 to 25 m"
  step  band-pass 0.04 1/m to (1 / (3 m)), order 4
  step  magnitude

zone 1 "Straight track"
  where             direction is straight
  minimum sections  1

zone 2 "Curves"
  where             direction is not straight
  minimum sections  2

sections
  zone  zone

quantity long_waves "Long waves only"
  of          Y at wheelset 1
  filter      resample every 0.25 m, then LONG
  value       p99.85
  difference  magnitudes
  limit       std 2 kN
