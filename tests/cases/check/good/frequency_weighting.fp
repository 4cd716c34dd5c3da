protocol frequency-weighting "Vertical comfort in the manner of ISO 2631-1: weighting Wk by poles and zeros"
  axis  distance in m
  time  time in s

place running_gear
  members  I, II

section zone "Test zone"
  one of  zones

section direction "Direction"
  one of  right, left, straight

channel az "Vertical acceleration of the car body"
  in  m/s^2
  at  each running_gear

filter Wk "Frequency weighting Wk"
  step    transfer function poles 0.4 Hz quality 0.70711 zeros 0 Hz
  step    transfer function poles 100 Hz quality 0.70711, plain
  step    transfer function poles 12.5 Hz quality 0.63 zero 12.5 Hz
  step    transfer function poles 3.35 Hz quality 0.91 zeros 2.37 Hz quality 0.91, gain (2.37^2 / 3.35^2)
  source  "ISO 2631-1:1997, Annex A: f1 0.4 Hz, f2 100 Hz, f3 and f4 12.5 Hz, Q4 0.63, f5 2.37 Hz, Q5 0.91, f6 3.35 Hz, Q6 0.91"
  note    "Not pre-warped at 100 Hz, so that a record of 200 samples a second can be weighted."

filter LAG "One pole, and a gain that makes an impulse of an acceleration"
  step  transfer function pole 5 Hz, gain 2 s, zero-phase

zone 1 "Straight track"
  where             direction is straight
  minimum sections  1

zone 2 "Curves"
  where             direction is not straight
  minimum sections  2

sections
  zone  zone

quantity az_weighted "Weighted vertical acceleration, rms over 5 s"
  of          az
  filter      Wk, then sliding rms 5 s every 5 s
  value       p95
  difference  signed
  limit       std 0.05 m/s^2

quantity az_lagged "In another unit than the signal"
  of          az
  filter      LAG
  in          m/s
  value       median
  difference  signed
  limit       std 0.1 m/s

quantity az_shape "A transfer function over the length"
  of          az
  filter      resample every 0.25 m, then transfer function pole (1 / (3 m)) zero (1 / (30 m)), causal-from-rest
  value       rms
  difference  signed
  limit       std 0.05 m/s^2
