protocol find-zone "Zones without a length, data that depend on the zone, groups that are none"
  axis  distance in m
  time  time in s

section zone "Zone"
  one of  zones

section a "One"
  in     kN
  found  mean of F when zone is 1, otherwise 0 kN

channel F "Force"
  in  kN

zone 1 "All"
  where  a > 0 kN

zone 2 "Others"
  minimum length  100 m

sections
  use   found sections
  step  1 m
  zone  zone
  keep  at most 3 for each a

quantity F_mean
  of          F
  value       mean
  difference  signed
  limit       std 1 kN
