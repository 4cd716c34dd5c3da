protocol uses_too_much "Texts that cannot be used"
  uses  sprague-geers
  uses  plausibility-signal
  uses  plausibility-signals
  axis  distance in m

channel Y "Guiding force"
  in      kN
  column  "Y"

quantity Y_max "Largest guiding force"
  of          Y
  value       maximum
  difference  signed
  limit       each 2 kN

sections
  removed  20 %
