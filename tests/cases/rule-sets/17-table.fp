protocol limit-table "Limit by interpolation in a table of speeds"
  extends  "base.fp"

define limit_of_speed "2 kN up to 60, 3 at 100, 5 at 140, 6 kN from 160 km/h, linear between"
  is  table speed: (60 km/h, 2 kN), (100 km/h, 3 kN), (140 km/h, 5 kN), (160 km/h, 6 kN), held

quantity Y_max "Largest guiding force"
  of          Y at wheelsets 1, 3
  filter      LP20
  value       p99.85
  difference  signed
  limit       each limit_of_speed
