protocol removed_share "A share of the sections that is none"
  axis  distance in m

channel Y "Guiding force"
  in      kN
  column  "Y"

quantity Y_max "Largest guiding force"
  of          Y
  value       maximum
  difference  signed
  limit       each 2 kN

sections
  removed  at most 3 m
