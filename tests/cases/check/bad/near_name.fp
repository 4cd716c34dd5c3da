protocol near_name "A variant with two slips"
  extends  en14363-2016-annex-t-found-sections

parameter speed_chang
  default  5 km/h

find deficency
  require  |cant_deficiency| <= 200

zone 5 "Another zone"
  where  radius < 200 m
  minimum length  50 m
