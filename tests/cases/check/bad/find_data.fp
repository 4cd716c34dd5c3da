protocol find-data "Section data that need each other"
  axis  distance in m
  time  time in s

section a "One"
  in     m
  found  b + 1 m

section b "Other"
  in     m
  found  a - 1 m

channel F "Force"
  in  kN

sections
  use  found sections

quantity F_mean
  of          F
  value       mean
  difference  signed
  limit       std 1 kN
