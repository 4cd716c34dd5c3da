# The way of the paper named under `source`: sections are cut out of continuous runs, at most nine of each zone and country are kept.

protocol en14363-2016-annex-t-found-sections "Validation by on-track tests, EN 14363:2016 Annex T, with sections found in continuous runs"
  extends  en14363-2016-annex-t
  source   "Goetz & Polach, Verification and validation of simulations in a rail vehicle certification"
           "context, Table 1 and section 4.1"
  author   "Fishplate"
  scope    "As Annex T. The test sections are looked for in continuous runs: almost constant speed, full"
           "curve or straight track, length by zone. At most nine sections of each zone and country are kept."

parameter speed_change "Largest change of the speed inside a section"
  default  2 km/h
  range    0.1 km/h to 20 km/h
  source   "Section 4.1: almost constant speed"
  note     "The number is this protocol's own."

parameter steady_before "How far before a section the curve must be full already"
  default  30 m
  range    0 m to 200 m
  note     "This protocol's own: the vehicle has passed the transition by more than its length."

parameter steady_behind "How far behind a section the curve must still be full"
  default  15 m
  range    0 m to 200 m
  note     "This protocol's own: half the length of a vehicle and a few metres."

section radius
  found  1 / |mean of curvature| when |mean of curvature| >= 0.00001 1/m

section direction
  found  right when mean of curvature >= 0.00001 1/m,
         left when mean of curvature <= -0.00001 1/m,
         otherwise straight
  note   "Straight: radius above 100 km."

section cant
  found  |mean of track_cant|

section cant_deficiency
  found  1500 mm * speed^2 / (9.81 m/s^2 * radius) - cant when direction is not straight, otherwise 0 mm

section speed
  found  mean of running_speed

section country "Country"
  one of  any word
  note    "Of the run. The database of the paper was measured in IT, FR, DE and CH."

channel running_speed "Speed"
  in      km/h
  column  "speed"

sections
  use     found sections
  step    1 m
  margin  30 m
  keep    at most 9 for each zone and country

find full_curve "Full curve or straight track"
  require  range of curvature <= 2 % * |mean of curvature| + 0.00001 1/m and range of track_cant <= 5 mm
  lead     steady_before
  tail     steady_behind
  source   "Section 3.2"
  note     "The tolerances are this protocol's own; that of the curvature is the one of Annex T's check."

find steady_speed "Almost constant speed"
  require  range of running_speed <= speed_change
  source   "Section 4.1"

find deficiency "Cant deficiency as in a test of this zone"
  require  |cant_deficiency| <= 40 mm when zone is 1, otherwise 60 mm <= cant_deficiency <= 150 mm
  note     "Curves are run with a cant deficiency near the admissible one; 60 mm and 150 mm are this"
           "protocol's own."
