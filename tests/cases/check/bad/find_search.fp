protocol find-search "Searches that cannot be meant"
  extends  en14363-2016-annex-t

channel running_speed "Speed"
  in      km/h
  column  "speed"

section zone
  found  1

section radius
  found  1 / |mean of curvature| + cant_deficiency * 0

section cant
  found  mean of curvature

section cant_deficiency
  found  radius * 0

section speed
  found  mean of running_speed when zone is 1, otherwise 0 km/h

section direction
  found  right when mean of curvature > 0 1/m, otherwise forward

sections
  use     found sections
  step    0 m
  margin  2 s
  keep    nine for each zone

find one_sided "A signal of the section"
  require  mean of (running_speed - speed) <= 2 km/h

find both "From both sides"
  require  rms of (simulated - measured) <= 1 kN

find number "No condition"
  require  range of running_speed
  lead     -3 m

find unknown "A name that is none"
  require  range of runing_speed <= 2 km/h
