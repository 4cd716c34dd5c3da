protocol p

quantity Y_max
  valeu            larger of |p0.15|, |p99.85|
  minimum signal   2
  colour           red

zone 1
  limit  std 9 kN
