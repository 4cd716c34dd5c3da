protocol rational-powers "Powers that are no whole numbers"
  axis  distance in m
  time  time in s

parameter exponent "Exponent of the index"
  default  0.3

channel Y "Guiding force"
  in      kN
  column  "Y_1R"

signal energy "Integral of the square"
  is  integral(Y * Y)

signal root "Square root of the force"
  is  Y^0.5
  in  kN^0.5

quantity dose "Root of the integral of the square"
  of          energy
  value       sqrt(last - first)
  in          kN*m^0.5
  difference  signed
  limit       mean 100 kN*m^0.5

quantity dose_by_power "The same by a power"
  of          energy
  value       (last - first)^(1/2)
  in          kN m^0.5
  difference  signed
  limit       mean 3.2 kN*m^(1/2)

quantity third "Third root of the mean"
  of          Y
  value       mean^(1/3)
  in          kN^(1/3)
  difference  signed
  limit       mean 1 kN^(1/3)

quantity index "An index by a power of 0.3"
  from   measured
  of     Y
  value  4.42 * (|mean| / (1 kN))^exponent
  limit  each 12

quantity root_first "First sample of the root"
  from   measured
  of     root
  value  first^-2 * 1 kN^2
  in     kN
  where  radius > 600 m
  limit  each 8 kN

section radius "Radius"
  in       m
  default  1000 m
