protocol faults-of-found-sections "What is wrong with sections that are looked for"
  extends  en14363-2016-annex-t-found-sections

section zone
  found  1 when speed > 100 km/h, otherwise 2

section speed
  found  mean of running_speed when zone is 1, otherwise 100 km/h

find unsteady
  require  range of (running_speed * cant) <= 1 m^2/s
