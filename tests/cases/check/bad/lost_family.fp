protocol lost-family "A family that cannot be expanded hides nothing else"
  extends  en14363-2016-annex-t

filter {band}_BP
  for each  band in low, high
  step      band-pass {edges}

quantity Y_braces
  of          Y at wheelset {wheelset}
  value       median
  difference  signed
  limit       std 3 kN

quantity Y_low
  of          Y
  filter      low_BP
  value       median
  difference  signed
  limit       std 3 mm

quantity Y_high
  of          Y
  filter      LP2O
  value       median
  difference  signed
  limit       std 3 kN

verdict forces
  of     Y_braces, Y_hihg
  holds  when every limit holds
