protocol instability "Running stability in the manner of EN 14363: sliding rms of the sum of guiding forces"
  axis  distance in m
  time  time in s

parameter frequency "Frequency of the unstable motion, from the test"
  default  6 Hz
  range    1 Hz to 20 Hz

place wheelset
  members  1, 2

place side
  members  R, L
  alias    outer is L when direction is right, R when direction is left

vehicle category "Vehicle category"
  one of  passenger, freight

vehicle Q0 "Static wheel force"
  in  kN

section zone "Test zone"
  one of  zones

section radius "Curve radius"
  in  m

section direction "Direction"
  one of  right, left, straight

section cant_deficiency "Cant deficiency"
  in  mm

section speed "Speed"
  in  km/h

channel Y "Guiding force"
  in      kN
  at      each wheelset and side
  column  "Y_{wheelset}{side}"

signal SigmaY "Sum of guiding forces"
  is  Y at side R + Y at side L
  at  each wheelset
  in  kN

filter BAND "Band around the frequency of the unstable motion"
  step  band-pass (frequency - 2 Hz) to (frequency + 2 Hz), order 2, zero-phase
  step  sliding rms 100 m every 10 m

zone 1 "Straight track"
  where             direction is straight
  minimum sections  1

zone 2 "Curves"
  where             direction is not straight
  minimum sections  2

sections
  zone  zone

quantity SigmaY_rms "Sum of guiding forces, sliding rms"
  of          SigmaY
  filter      BAND
  value       maximum
  difference  magnitudes
  limit       std (0.1 * (10 kN + 2/3 * Q0))
  limit       mean 2/3 of limit of std
