# A stationary test without track, sections or zones: angles over cant instead of forces over distance.

protocol stationary-sway "Matching error of the hysteresis loops of a stationary sway test"
  uses     plausibility-signals
  edition  "Similar to EN 15273-2:2013, stationary sway test"
  source   "Goetz & Polach, section 3.3: largest and mean matching error on the hysteresis loop of the"
           "primary and secondary roll angle"
  author   "Fishplate"
  scope    "Models used for gauging: roll angles of the two suspension stages while the vehicle is slowly"
           "canted to both sides. The limits are parameters; the user enters the values of the standard."
  axis     time in s
  note     "The simulated angle is compared with the measured one at the same cant on the same branch of the"
           "loop, rising or falling."

parameter largest_error "Limit of the largest matching error"
  optional  not assessable
  range     0.01 mrad to 100 mrad

parameter mean_error "Limit of the mean matching error"
  optional  not assessable
  range     0.01 mrad to 100 mrad

channel cant "Cant of the vehicle"
  in  mm

channel primary_roll "Roll angle of the primary suspension"
  in      mrad
  column  "primary roll angle"

channel secondary_roll "Roll angle of the secondary suspension"
  in      mrad
  column  "secondary roll angle"

plausibility copies
  distinct  channels, sides
  note      "A stationary test is repeated, and each loop may be compared with the same simulation."

sections
  use      whole records
  minimum  1

quantity primary_largest "Primary suspension, largest matching error"
  of      primary_roll
  metric  hysteresis maximum over cant
  limit   maximum largest_error

quantity primary_mean "Primary suspension, mean matching error"
  of      primary_roll
  metric  hysteresis mean over cant
  limit   maximum mean_error

quantity secondary_largest "Secondary suspension, largest matching error"
  of      secondary_roll
  metric  hysteresis maximum over cant
  limit   maximum largest_error

quantity secondary_mean "Secondary suspension, mean matching error"
  of      secondary_roll
  metric  hysteresis mean over cant
  limit   maximum mean_error

verdict
  validated  when every limit holds
