protocol family-lists "Families that cannot be written out"
  axis  distance in m
  time  time in s

place wheelset
  members  1, 2

place running_gear
  members  I, II

channel Y "Guiding force"
  in  kN
  at  each wheelset

quantity a_{part} "The {prt} error of {part}, {"
  for each    part in magnitude, phase
  of          {Part}
  value       rms
  difference  signed
  note        "Of }{ part }."

quantity b_{part}
  of      Y
  metric  sprague-geers {part}

quantity c
  of      Y
  metric  sprague-geers {part}

quantity d_{x}
  for each  x in
  of        Y

quantity e_{x}
  for each  x in a, , b
  of        Y

quantity f_{x}
  for each  wheelset in 1, 2 and x in a
  of        Y

quantity g_{x}
  for each  x in a, b and y in 1 and x in 2
  of        Y

quantity h_{x}_{y}
  for each  x, y in (a, b), c, (d, e, f)
  of        Y

quantity i_{x}
  for each  x in runing gears
  of        Y

quantity j_{x}
  for each  x of a, b
  of        Y

quantity k_{x}
  for each  x in a, b and c
  of        Y

quantity l_{x}{y}{z}{u}
  for each  x in 0, 1, 2, 3, 4, 5, 6, 7, 8, 9 and y in 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
  for each  z in 0, 1, 2, 3, 4, 5, 6, 7, 8, 9 and u in 0, 1
  of        Y

quantity m_{x}
  for each  x in ""
  of        Y
