protocol sliding-values "Values of sliding windows"
  axis  distance in m
  time  time in s

channel Y "Guiding force"
  in      kN
  column  "Y_1R"

signal Y_squared "A parabola along the track"
  is  Y * Y / (1 kN)
  in  kN

parameter which "Value of the window"
  one of   maximum, minimum
  default  maximum

quantity throughout "Exceeded throughout 5 ft"
  of          Y
  filter      sliding minimum 5 ft every sample
  value       maximum
  difference  signed
  limit       mean 3 kN

quantity any_second "Peak to peak in any second"
  of          Y
  filter      sliding range 1 s every sample
  value       maximum
  difference  signed
  limit       mean 3 kN

quantity scatter "Standard deviation in 2 m"
  of          Y
  filter      sliding std 2 m every 0.5 m
  value       p50
  difference  signed
  limit       mean 3 kN

quantity about_trend "About the line, in 2 m"
  of          Y_squared
  filter      sliding rms_about_trend 2 m every 1 m
  value       minimum
  difference  signed
  limit       mean 3 kN

quantity whole_about_trend "About the line, of the section"
  of          Y_squared
  value       rms_about_trend
  difference  signed
  limit       mean 3 kN

quantity steepest "Largest slope in 2 m"
  of          Y
  filter      sliding slope 2 m every 1 m
  value       maximum
  difference  signed
  in          kN/m
  limit       mean 3 kN/m

quantity chosen "By a choice, 75 % value"
  of          Y
  filter      sliding which 2 m every 10 m, then sliding p75 50 m every sample
  value       first
  difference  signed
  limit       mean 3 kN
