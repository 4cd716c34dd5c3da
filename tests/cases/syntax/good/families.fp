protocol families "Blocks that stand for several"
  axis  distance in m

remove
  quantity  every
  quantity  {channel}_{part}
  zone      every
  limit     Y_max
  limit     every mean

signal Sigma{force}  # a comment beside
  for each  force in Y, Q
  is        {force} at side R + {force} at side L
  named     "Sigma{force}_{wheelset}"

quantity {channel}_{part} "{title}, {part} error"
  # where each is looked at
  for each  channel, title, position in (Y, Guiding force, wheelset 1 and side L),
            (Q, "Vertical \"wheel\" force, of one wheel", wheelset 1 and side L),
            (az, Acceleration, running gear I)
  for each  part in magnitude, phase and band in 0.4 Hz to 2 Hz, 2 Hz to 10 Hz  # two bands
  of        {channel} at {position}
  filter    band-pass {band}
  metric    sprague-geers {part}
  limit     each {part}_limit

quantity {force}_max
  for each    force in Y, Q
  of          {force}
  value       p{percent}
  difference  |simulated| - |measured|
