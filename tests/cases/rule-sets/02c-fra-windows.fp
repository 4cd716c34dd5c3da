protocol fra-213-333-windows "FRA 213.333: peak to peak of the car body in any second of a run"
  axis  time in s
  time  time in s

place running_gear
  members  I, II

channel ay "Carbody lateral"
  in  m/s^2
  at  each running_gear

channel az "Carbody vertical"
  in  m/s^2
  at  each running_gear

sections
  use  whole records

quantity carbody_{dir} "Carbody {dir}, peak to peak in 1 s"
  for each  dir, ch, lim in (lateral, ay, 0.65 gn), (vertical, az, 1.0 gn)
  of        {ch}
  filter    low-pass 10 Hz, order 4, zero-phase, then sliding range 1 s every sample
  from      measured
  value     maximum
  limit     each {lim}
