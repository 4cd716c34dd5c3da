# Limits on the wrong side of the best value, and limits that come to nothing.
protocol wrong-side "Limits that keep the best value out, or nothing"
  axis  distance in m
  time  time in s

parameter which "A side"
  default  leading
  one of   leading, trailing
  at       wheelset

place wheelset
  members  1, 2

parameter some_wheelsets "Wheelsets"
  default  1, 3
  at       wheelset

parameter some_bogies "Bogies"
  default  1
  at       bogies

channel Y "Guiding force"
  in  kN
  at  each wheelset

section radius "Curve radius"
  in       m
  optional  later

section cant "Cant"
  in  mm

quantity probability "Best 1"
  of      Y at wheelset 1
  metric  matching probability
  limit   each 0.5
  limit   mean at least 1.5
  limit   std at least 0.1

quantity error "Best 0"
  of      Y at wheelset 1
  metric  root-mean-square difference
  limit   each at least 2 kN

quantity ratio "Best 1, of both sides"
  of          Y at wheelset 1
  value       median
  difference  simulated / measured
  limit       mean 0.9
  limit       each at least 1.1

quantity difference_at_least "Best 0"
  of          Y at wheelset 1
  value       median
  difference  signed
  limit       mean at least 1 kN

quantity meaning "A statistic is its limit"
  of          Y at wheelset 1
  value       median
  difference  signed
  limit       mean 46.4 kN
  limit       std (46.4 kN - mean) / 3

quantity no_number "More than a number can be"
  of          Y at wheelset 1
  value       rms / 0
  difference  signed
  where       cant > 50 mm
  limit       std 1e400

verdict
  minimum pairs  24
