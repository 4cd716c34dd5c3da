protocol small "A protocol for trials"
  axis  distance in m
  time  time in s

channel Y "Guiding force"
  in      kN
  column  "Y_1R"

quantity a
  from    measured
  of      Y
  filter  sliding maximun 2 m every 0.5 m
  value   maximum
  limit   each 3 kN

quantity b
  from    measured
  of      Y
  filter  sliding held 2 m every sample
  value   maximum
  limit   each 3 kN

quantity c
  from    measured
  of      Y
  filter  sliding range 1 s every 0.1 s, integral
  value   maximum
  limit   each 3 kN

quantity d
  from    measured
  of      Y
  filter  sliding p101.5 1 s every sample
  value   maximum
  limit   each 3 kN

quantity e
  from    measured
  of      Y
  filter  sliding minimum 5 ft every 0.1 s
  value   maximum
  limit   each 3 kN

quantity f "The slope of a force is no force"
  from    measured
  of      Y
  filter  sliding slope 2 m every sample
  value   maximum
  limit   each 3 kN
