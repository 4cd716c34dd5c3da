protocol small "A protocol for trials"
  axis  distance in m
  time  time in s

zone 1 "All"
  where  speed > 0 km/h

section zone "Zone"
  one of  zones

sections
  zone  zone

section speed "Speed"
  in  km/h

channel Y "Guiding force"
  in      kN
  column  "Y_1R"

quantity a "Out of order"
  of          Y
  value       median
  difference  signed
  limit       each table speed: (100 km/h, 2 kN), (60 km/h, 3 kN)

quantity b "Twice the same place"
  of          Y
  value       median
  difference  signed
  limit       each table speed: (60 km/h, 2 kN), (60 km/h, 3 kN), (80 km/h, 3 kN), held

quantity c "A table over a speed has points of a speed"
  of          Y
  value       median
  difference  signed
  limit       each table speed: (60 km/h, 2 kN), (80 m, 3 kN)

quantity d "It gives forces"
  of          Y
  value       median
  difference  signed
  limit       each table speed: (60 km/h, 2 kN), (80 km/h, 3 m)

quantity e "Constant points"
  of          Y
  value       median
  difference  signed
  limit       each table speed: (60 km/h, 2 kN), (80 km/h, speed)

quantity f "A plain number outside the points"
  of          Y
  value       median
  difference  signed
  limit       mean table (3): (1, 2 kN), (2, 3 kN)

quantity g "The bound is no length"
  of          Y
  value       median
  difference  signed
  limit       each table speed: (60 km/h, 2 m), (80 km/h, 3 m), held
