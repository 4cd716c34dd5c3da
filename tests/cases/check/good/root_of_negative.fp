protocol root-of-negative "A root of samples that are negative at first"
  axis  distance in m
  time  time in s

channel Y "Guiding force"
  in      kN
  column  "Y_1R"

signal below "Square root about the middle"
  is  ((Y - 4.6 kN) / (1 kN))^(1/2)

quantity nothing "Of a negative number there is no root"
  from   measured
  of     below
  value  first
  limit  each 8
