protocol trial-k-own-rules "Two classes, limits by section, own metric, confidence"
  extends  en14363-2016-annex-t

remove
  limit  Y_max mean
  limit  Y_max std

quantity Y_max
  limit  std 9 kN when vehicle.category is passenger, otherwise 11 kN
  limit  each 30 kN when speed > 120 km/h, otherwise 25 kN
  limit  (upper 95 % of std) 11 kN
  limit  (|mean| + 3 * std) 46.4 kN

quantity Y_own "Own metric by expression"
  of      Y at wheelsets 1, 3
  filter  LP20
  metric  rms of (simulated - measured) / rms of measured
  limit   p95 1

quantity N_MV "Mean comfort of two directions, band-limited"
  of          ay
  filter      CW
  value       6 * sqrt(p95^2 + (p95 of az)^2) / (1 m/s^2)
  difference  signed
  limit       std 3

filter CW "Band limits of the weighting"
  step  band-pass 0.4 Hz to 10 Hz
  step  remove mean

filter Wd "Frequency weighting Wd"
  step  transfer function poles 0.4 Hz quality 0.70711 zeros 0 Hz
  step  transfer function poles 100 Hz quality 0.70711, plain
  step  transfer function poles 2 Hz quality 0.63 zero 2 Hz

quantity ay_weighted "Weighted lateral acceleration, 95 % of windows of 5 s"
  of          ay
  filter      Wd, then sliding rms 1 s every 0.5 s
  value       p95
  difference  signed
  limit       std 0.05 m/s^2
