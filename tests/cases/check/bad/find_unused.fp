protocol found-sections-unused "Conditions on found sections, and none is looked for"
  extends  en14363-2016-annex-t

channel running_speed "Speed"
  in      km/h
  column  "speed"

sections
  keep  nine for each zone

find steady_speed
  require  range of running_speed <= 2 km/h
