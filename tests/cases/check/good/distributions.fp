protocol distributions "Metrics of distributions: at points, after a window, after resampling"
  axis  distance in m
  time  time in s

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

zone 1 "Straight track"
  where             direction is straight
  minimum sections  1

zone 2 "Curves"
  where             direction is not straight
  minimum sections  2

sections
  zone  zone

quantity matching "Agreement of the distributions, 50 points of each"
  of      Y at wheelset 1
  filter  low-pass 20 Hz
  metric  matching probability, 50 points
  limit   minimum at least 0.05

quantity matching_of_windows "The same of the means of windows"
  of      Y at wheelset 1
  filter  low-pass 20 Hz, then sliding mean 2 m every 0.5 m
  metric  matching probability
  limit   minimum at least 0.05

quantity area "Distance of the distributions on equal steps of length"
  of      Y at wheelset 2
  filter  resample every 0.25 m
  metric  area between distributions, points 100
  limit   mean 2 kN

quantity area_as_recorded "Distance of the distributions of the samples, of which the sides may have different numbers"
  of      Y at wheelset 2
  metric  area between distributions
  limit   mean 2 kN
