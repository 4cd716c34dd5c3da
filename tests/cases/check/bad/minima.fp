protocol minima "Minimum counts that cannot be meant"
  extends  en14363-2016-annex-t

quantity Y_max
  minimum pairs  2.5 for each zone
  minimum pairs  3 kN for each wheelset
  minimum pairs  3 for each whelset
  minimum pairs  2 for each running gear

quantity Q_max
  minimum pairs  24
  minimum pairs  20
  minimum pairs  3 for each zone and side
  minimum pairs  4 for each side and zone

quantity az_max
  minimum pairs  3 for zones 3, 9
  minimum pairs  3 for each radius

quantity ay_max
  minimum pairs    3 each zone
  minimum signals  2 for each zone

verdict
  minimum pairs  3 for each country
