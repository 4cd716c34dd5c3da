protocol small "A protocol for trials"
  axis  distance in m
  time  time in s

section speed "Speed"
  in  km/h

channel Y "Guiding force"
  in      kN
  column  "Y_1R"

quantity a "A third is no decimal"
  from   measured
  of     Y
  value  mean^0.333
  limit  each 3 kN

quantity b
  from   measured
  of     Y
  value  mean^(2 kN)
  limit  each 3 kN

quantity c
  from   measured
  of     Y
  value  (mean / (1 kN))^(speed / (1 km/h))
  limit  each 3

quantity d
  from   measured
  of     Y
  value  mean^0.5
  limit  each 3 kN

quantity e
  from   measured
  of     Y
  value  (-8)^(1/3) * mean
  limit  each 3 kN

signal s
  is  Y^0.5
  in  kN^0.4

quantity f
  from   measured
  of     s
  value  mean
  limit  each 3 kN^0.5

quantity g
  from   measured
  of     Y
  value  mean
  in     kN^0.333
  limit  each 3 kN
