protocol en12299-nmv "EN 12299 style mean comfort, measured against simulated"
  axis  time in s
  time  time in s

place running_gear
  members  I, II

channel ay "Lateral acceleration"
  in  m/s^2
  at  each running_gear

channel az "Vertical acceleration"
  in  m/s^2
  at  each running_gear

# Wd: high-pass 0.4, low-pass 100, transition 2 Hz / 2 Hz Q 0.63
filter Wd "Lateral weighting"
  step  transfer function poles 0.4 Hz quality 0.70711 zeros 0 Hz
  step  transfer function poles 100 Hz quality 0.70711, plain
  step  transfer function poles 2 Hz quality 0.63 zero 2 Hz

# Wb: high-pass 0.4, low-pass 100, transition 16 Hz / 16 Hz Q 0.63, upward step 2.5/4, Q 0.8
filter Wb "Vertical weighting"
  step  transfer function poles 0.4 Hz quality 0.70711 zeros 0 Hz
  step  transfer function poles 100 Hz quality 0.70711, plain
  step  transfer function poles 16 Hz quality 0.63 zero 16 Hz
  step  transfer function poles 4 Hz quality 0.8 zeros 2.5 Hz quality 0.8, gain (1.024 * 2.5^2/4^2)

sections
  percentiles  linear

quantity NMV "Mean comfort index, of y and z"
  of      az
  filter  Wb, then sliding rms 5 s every 5 s
  from    measured
  value   6 * hypot(p95, p95 of (ay through (Wd, then sliding rms 5 s every 5 s))) / (1 m/s^2)
  limit   each 2.5
  in      -

quantity NMV_difference "Mean comfort index, simulated less measured"
  of          az
  filter      Wb, then sliding rms 5 s every 5 s
  value       6 * hypot(p95, p95 of (ay through (Wd, then sliding rms 5 s every 5 s))) / (1 m/s^2)
  difference  signed
  limit       each 0.3
  in          -
