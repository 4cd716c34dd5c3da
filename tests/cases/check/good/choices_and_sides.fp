# A choice in place of the word it stands for, a selection of positions, one side alone, vehicle data that may be absent.
protocol choices "Words, selections and sides"
  axis  distance in m
  time  time in s

parameter which "The direction that is looked at"
  default  right
  one of   right, left

parameter some_wheelsets "Wheelsets"
  default  2, 3
  at       wheelset

place wheelset
  members  1, 2, 3, 4

vehicle admissible_speed "Admissible speed"
  in        km/h
  optional  not assessable

section zone "Zone"
  one of  zones

section direction "Direction"
  one of  right, left, straight

channel Y "Guiding force"
  in      kN
  at      each wheelset
  column  "Y_{wheelset}"

zone 1 "Curves"
  where           direction is which
  minimum length  100 m when vehicle.admissible_speed <= 140 km/h, otherwise 250 m

sections
  zone  zone

quantity measured_alone "The measured value"
  of             Y at wheelsets some_wheelsets
  value          median
  difference     measured
  limit          each 60 kN for each zone
  minimum pairs  1
  where          direction is not straight
