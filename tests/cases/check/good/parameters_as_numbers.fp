protocol parameters-as-numbers "A parameter wherever a number stands"
  axis  distance in m
  time  time in s

section speed "Speed"
  in  km/h

channel Y "Guiding force"
  in      kN
  column  "Y_1R"

parameter level "Percentile of the values"
  default  99.85 %

parameter confidence "Confidence of the test"
  default  90 %

parameter share "Percentile of the pairs"
  default  75 %

parameter order "Poles of a pass"
  default  2

parameter points "Points of a distribution"
  default  200

parameter enough "Quantities that hold"
  default  2

filter LP "Low-pass"
  step  low-pass 20 Hz, order order

quantity extreme "By a parameter"
  of          Y
  value       percentile level
  difference  signed
  limit       (mean) 3 kN
  limit       percentile share 3 kN
  limit       upper confidence of mean 5 kN
  limit       lower (1 - 0.1) of mean 5 kN
  limit       (prediction over speed at 80 km/h, confidence confidence) 100 kN
  report      percentile share
  report      percentile 25 %

quantity named "Of a named signal"
  of          Y
  value       percentile (1 - level) of Y
  difference  signed
  limit       mean 3 kN

quantity windows "In windows"
  of          Y
  filter      LP, then sliding (percentile share) 2 m every 1 m
  value       percentile level
  difference  signed
  limit       mean 3 kN

quantity matching
  of      Y
  filter  LP
  metric  matching probability, points points
  limit   minimum at least 0

quantity matching_too
  of      Y
  filter  LP
  metric  matching probability, points points
  limit   minimum at least 0

verdict enough_hold
  holds  when at least enough quantities hold
