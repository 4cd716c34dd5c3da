# One block for many: over words, pairs, bands, numbers and the members of a place.

protocol families "Families of blocks"
  axis  distance in m
  time  time in s

parameter {part}_limit "Limit of the {part} error"
  for each  part, most in (magnitude, 25 %), (phase, 0.3)
  default   {most}

place wheelset
  members  1, 2

place side
  members  R, L

vehicle Q0 "Static wheel force"
  in  kN

section zone "Test zone"
  one of  zones

section {datum} "{title}"
  for each  datum, title, unit in (radius, Curve radius, m), (speed, Speed, km/h)
  in        {unit}

channel {force} "{title}"
  for each  force, title in (Y, Guiding force), (Q, Vertical wheel force)
  in        kN
  at        each wheelset and side
  column    "{force}_{wheelset}{side}"

channel ay "Lateral acceleration"
  in  m/s^2

signal Sigma{force} "{title}"
  for each  force, title in (Y, "Sum of guiding forces, \"Prud'homme\""), (Q, Axle load)
  is        {force} at side R + {force} at side L
  at        each wheelset
  named     "Sigma{force}_{wheelset}"

filter LP{edge} "Low-pass filter {edge} Hz"
  for each  edge in 20, 40
  step      low-pass {edge} Hz, order 4

define is_{word} "Curves of the {word} class"
  for each  word, low, high in (small, 250 m, 600 m), (large, 600 m, 2500 m)
  is        {low} <= radius < {high}

zone {zone} "Zone {zone}"
  for each          zone, condition, least in (1, radius > 2500 m, 1), (2, is_large, 2),
                    (3, "is_small and speed < 80 km/h", 3)
  where             {condition}
  minimum sections  {least}

check {channel}_moves "{channel} does not stand still"
  for each   channel in Y, Q
  require    range of {channel} at wheelset 1 side R > 0.1 kN
  otherwise  note

plausibility load_{wheel} "Wheelset {wheel}: vertical forces against the static load"
  for each  wheel in wheelsets
  of        SigmaQ at wheelset {wheel}
  require   median near 2 * Q0 within a factor of 1.4
  cause     "the load of an axle in place of that of a wheel, wheelset {wheel}"

sections
  zone  zone

quantity {force}_{part}_{edge} "{force}, {part} error below {edge} Hz"
  for each  force in Y, Q
  for each  part in magnitude, phase and edge in 20, 40
  of        {force} at wheelset 1
  filter    LP{edge}
  metric    sprague-geers {part}
  limit     each {part}_limit

quantity ay_{band} "Lateral acceleration, rms value from {band}"
  for each    band in 0.4 Hz to 2 Hz, 2 Hz to 10 Hz
  of          ay
  filter      band-pass {band}, order 4
  value       rms
  difference  signed
  limit       std 0.15 m/s^2

quantity Q_{wheel}_{side_of} "Vertical force of wheel {wheel}{side_of}, {percent} % value"
  for each    wheel in wheelset and side_of in side
  for each    percent in 99.85
  of          Q at wheelset {wheel} and side {side_of}
  filter      LP20
  value       p{percent}
  difference  signed
  limit       std 6 kN

verdict
  validated  when every limit holds
