protocol outcomes "Outcomes in order"
  axis  distance in m
  time  time in s

channel Y "Guiding force"
  in      kN
  column  "Y_1R"

parameter scale "A factor of the differences"
  default  1
  range    0.1 to 10

quantity graded "Grades of a quantity"
  of          Y
  value       p99.85
  difference  scale * oriented
  outcome     excellent: holds when std <= 1 kN and |mean| <= 1 kN
  outcome     good: holds when std <= 5 kN and (count where |value| > 6 kN) <= 1
  outcome     fair: fails when std <= 9 kN
  outcome     poor: fails

quantity strict "A quantity with a limit"
  of          Y
  value       p99.85
  difference  scale * oriented
  limit       std 3 kN

quantity relaxed_{force} "The same with wider limits"
  for each    force in Y
  of          {force}
  value       p99.85
  difference  scale * oriented
  limit       std 6 kN

verdict relaxed "With relaxed limits"
  of     relaxed_{force}
  holds  when every limit holds

verdict strictly "With strict limits"
  of     strict
  holds  when every limit holds

verdict
  outcome  validated: holds when strictly holds
  outcome  validated with restriction: holds when relaxed holds
  outcome  not validated: fails
