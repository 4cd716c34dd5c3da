# A quantity that is reported without a limit, and has one.
protocol reported "Reported and limited"
  axis  distance in m
  time  time in s

channel Y "Guiding force"
  in  kN

quantity r "Correlation"
  of        Y
  metric    correlation
  reported  "A factor of another metric."
  limit     each at least 0.5
