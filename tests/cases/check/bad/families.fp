protocol families "Faults inside blocks of families, each told once"
  axis  distance in m
  time  time in s

place wheelset
  members  1, 2

channel Y "Guiding force"
  in      kN
  at      each wheelset
  column  "Y_{wheelset}{sid}"

channel {name} "Acceleration"
  for each  name in ay, az
  in        m/s^2
  column    "{name}{position}"

quantity {signal}_{part} "{signal}: {part} error"
  for each  signal, unit in (Y, kN), (ay, m/s^2), (az, m/s2), (yaw, mrad)
  for each  part in magnitude, phas
  of        {signal}
  filter    LP2O
  metric    sprague-geers {part}
  limit     each {part}_limit
  in        {unit}

quantity {signal}_max
  for each    signal in Y, ay
  of          {signal}
  difference  signed
  limit       std 1 kN

quantity {word}_of_all
  for each    word, other in (a, x), (b, y)
  of          Y
  value       rms
  difference  signed
  limit       std 1 kN

quantity {signal}_two "Members of one name"
  for each    signal in Y, ay and edge in 1 Hz, 2 Hz
  of          {signal}
  filter      low-pass {edge}
  value       rms
  difference  signed

quantity twice_{signal}
  for each    signal in Y, ay, Y
  of          {signal}
  value       rms
  difference  signed

quantity twice_Y
  of          Y
  value       rms
  difference  signed

quantity of_{edge}
  for each    edge in 1 Hz, 1/Hz
  of          Y
  filter      low-pass {edge}
  value       rms
  difference  signed

zone {zone}{sign}
  for each  zone, sign in (-, -)
  where     {sign}1 m > 0 m

define {name}
  for each  name in mean, p5
  is        1 kN
