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

parameter error "An error probability"
  default  5 %

parameter whole "More than all"
  default  99.85

parameter force "No share"
  default  3 kN

parameter some "No whole number"
  default  1.5

quantity a "The confidence is out of its range"
  of          Y
  value       median
  difference  signed
  limit       upper error of mean 3 kN

quantity b "So is the percentile"
  of          Y
  value       percentile whole
  difference  signed
  limit       mean 3 kN

quantity c "And that of a limit"
  of          Y
  value       median
  difference  signed
  limit       percentile whole 3 kN

quantity d "A force is no confidence"
  of          Y
  value       median
  difference  signed
  limit       (prediction over speed at 100 km/h, confidence force) 3 kN

quantity e "The speed is not constant"
  of          Y
  value       percentile speed of Y
  difference  signed
  limit       lower speed of mean 3 kN

quantity f "No number of points"
  of      Y
  metric  matching probability, some points
  limit   each at least 0.8

verdict some_hold
  holds  when at least some quantities hold
