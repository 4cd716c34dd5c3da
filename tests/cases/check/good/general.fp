# Things other than Annex T: limits by zone and speed, windows over length and time, spatial filters, slopes, outer wheels.
protocol general "What the language can say beside Annex T"
  axis  distance in m
  time  time in s

parameter hunting_frequency "Dominant frequency of the unstable motion"
  default  5 Hz

place wheelset
  members  1, 2

place side
  members  R, L
  alias    outer is L when direction is right, R when direction is left

vehicle bogie_mass "Mass of a bogie with its wheelsets"
  in  t

section zone "Test zone"
  one of  1, 2

section direction "Direction"
  one of  right, left, straight

section speed "Speed"
  in  km/h

channel Y "Guiding force"
  in      kN
  at      each wheelset and side
  column  "Y_{wheelset}{side}"

channel yb "Lateral acceleration of the bogie frame"
  in      m/s^2
  column  "yb"

signal SigmaY "Sum of guiding forces"
  is     Y at side R + Y at side L
  at     each wheelset
  in     kN
  named  "SigmaY_{wheelset}"

signal Y_outer "Guiding force of the outer wheel"
  is     Y at side outer
  at     each wheelset
  in     kN
  named  "Y_{wheelset}o"

filter HUNTING "Band around the unstable motion"
  step  band-pass (hunting_frequency - 2 Hz) to (hunting_frequency + 2 Hz), order 3
  step  sliding rms 100 m every 10 m

filter WAVES "Wavelengths above 3 m"
  step  resample every 0.25 m
  step  low-pass (1 / (3 m)), order 2

zone 1 "Straight track"
  where             direction is straight
  minimum sections  3

zone 2 "Curves"
  where             direction is not straight
  minimum sections  3

sections
  zone   zone
  where  speed >= 40 km/h

quantity instability "Instability, rms of the sum of guiding forces"
  of          SigmaY at wheelset 1
  filter      HUNTING
  value       maximum
  difference  signed
  limit       std 2 kN for zone 1
  limit       std 3 kN for zone 2
  limit       mean 2/3 of limit of std for each zone

quantity frame "Bogie frame acceleration"
  of          yb
  filter      low-pass 10 Hz, order 4, causal
  value       peak
  difference  magnitudes
  limit       each (12 m/s^2 - vehicle.bogie_mass / (5 t) * 1 m/s^2) * 0.1 when speed <= 120 km/h, otherwise 0.5 m/s^2

quantity outer "Outer wheels in curves"
  of          Y_outer at wheelsets 1, 2
  where       direction is not straight
  filter      WAVES
  value       p99.85 when direction is left, otherwise p0.15
  difference  oriented
  limit       p95 4 kN

quantity trend "Trend along the section"
  of          SigmaY
  filter      sliding mean 0.5 s every 0.1 s
  value       slope
  difference  signed
  in          kN/m
  limit       rms 1 kN/m, times 1.5 when vehicle.bogie_mass > 6 t

quantity likeness "Correlation of the sums"
  of      SigmaY
  filter  low-pass 20 Hz
  metric  correlation
  limit   each at least 0.8
  limit   mean at least 0.9

verdict
  validated  when at least 4 quantities hold
