protocol tables "Limits and signals by tables"
  axis  distance in m
  time  time in s

section speed "Speed"
  in  km/h

channel Y "Guiding force"
  in      kN
  column  "Y_1R"

parameter first_force "First point of the characteristic"
  default  0 kN

signal travel "Travel of a spring by its characteristic"
  is  table Y: (first_force, 0 mm), (4.4 kN, 2 mm), (5 kN, 8 mm), (30 kN, 58 mm)

define allowed "Between 60 and 100 km/h"
  is  table speed: (60 km/h, 2 kN), (100 km/h, 6 kN)

quantity difference "By the speed"
  of          Y
  value       median
  difference  signed
  limit       each allowed

quantity held "The ends hold"
  of          Y
  value       median
  difference  signed
  limit       each table speed: (75 km/h, 3 kN), (80 km/h, 5 kN), held

quantity travelled "Sample by sample"
  of          travel
  value       last - first
  difference  signed
  in          mm
  limit       mean 3 mm, times 2 when 1 > 2
