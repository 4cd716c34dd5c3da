# Acceptance by an on-track test of a measured vehicle, normal method. Rules in our own words; the text of the standard is not
# reproduced. No numeric table of the standard was at hand: every number is a parameter or says that it is from memory.

protocol en14363-on-track-assessment "On-track assessment of running safety, track loading and ride, EN 14363 normal method"
  uses     plausibility-signals
  edition  "EN 14363:2016, clause 7 (on-track tests, normal measuring method)"
  source   "EN 14363:2016; signals, filters and percentiles as in the public table of the GENSYS course on"
           "UIC 518 (gensys.se/course/UIC518_tests.html)"
  author   "Fishplate"
  scope    "Vehicles with bogies and measured wheel-rail forces. Estimated maxima in each test zone and for"
           "each wheelset, one-dimensional method. The vehicle file decides the limits: category, static"
           "wheel load, admissible speed, masses of the bogie."
  axis     distance in m
  time     time in s
  note     "Wheelsets and running gears are never mixed: each zone and wheelset has an estimate of its own."

# ---- statistical method
parameter k_safety "Multiple of the standard deviation, running safety"
  default      3
  range        0 to 5
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7, one-dimensional method"

parameter k_loading "Multiple of the standard deviation, track loading and ride"
  default      2.2
  range        0 to 5
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7, one-dimensional method"

parameter sections_per_zone "Sections required in each test zone"
  default      25
  range        1 to 200
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7 (50 in zone 3 in the edition of 2005)"

# ---- limits of running safety
parameter sum_base "Limit of the sum of guiding forces: part that does not depend on the load"
  default      10 kN
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7; form 10 + 2 Q0/3 in public source code"

parameter sum_factor_freight "Limit of the sum of guiding forces: factor of freight wagons"
  default      0.85
  range        0.5 to 1
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7"

parameter YQ_limit "Limit of Y/Q"
  default      0.8
  range        0.1 to 2
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7"

parameter instability_share "Limit of the rms value of the sum of guiding forces, over that of its maximum"
  default      0.5
  range        0.1 to 1
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7"

parameter hunting_frequency "Frequency of the unstable motion"
  default  5 Hz
  range    2.5 Hz to 15 Hz
  note     "A property of the vehicle: set it to the dominant frequency of the measured sum of guiding"
           "forces."

parameter instability_band "Half width of the band around the frequency of the unstable motion"
  default  2 Hz
  source   "EN 14363:2016, clause 7; public table of the GENSYS course"

parameter bogie_acceleration_base "Limit of the bogie acceleration: part that does not depend on the mass"
  default      12 m/s^2
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7"

parameter bogie_acceleration_slope "Limit of the bogie acceleration: decrease with the mass of the bogie"
  default      0.2 m/s^2/t
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7"

# ---- limits of track loading
parameter Q_base "Limit of the vertical wheel force: part that does not depend on the load"
  default      90 kN
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7"

parameter Q_cap_{speed} "Largest limit of the vertical wheel force, {words}"
  for each     speed, words, default in (160, "up to 160 km/h", 200 kN), (200, "up to 200 km/h", 190 kN),
               (250, "up to 250 km/h", 180 kN), (300, "up to 300 km/h", 170 kN),
               (above, "above 300 km/h", 160 kN)
  default      {default}
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7"

parameter Y_qst_limit_flat "Limit of the quasi-static guiding force, zones 2 and 3"
  default      60 kN
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7"

parameter Y_qst_base "Limit of the quasi-static guiding force in zone 4: part that does not depend on the radius"
  default      30 kN
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7"

parameter Y_qst_radius "Limit of the quasi-static guiding force in zone 4: part over the mean radius of the sections"
  default      10500 kN*m
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7"

parameter Q_qst_limit_{load} "Limit of the quasi-static vertical wheel force, {words}"
  for each     load, words, default in (light, "axle loads up to 225 kN", 145 kN),
               (heavy, "axle loads above 225 kN", 155 kN)
  default      {default}
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7"

parameter B_qst_share "Share of the quasi-static vertical force in the combined rail loading"
  default      0.83
  range        0 to 2
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7"

parameter B_qst_limit "Limit of the combined rail loading"
  default      180 kN
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7"

# ---- limits of ride
parameter {value}_limit_{kind} "Limit of {value}, {words}"
  for each     kind, words, value, default in (locomotive, locomotives, ay_max, 2.5 m/s^2),
               (locomotive, locomotives, az_max, 2.5 m/s^2), (locomotive, locomotives, ay_qst, 1.5 m/s^2),
               (locomotive, locomotives, ay_rms, 0.5 m/s^2), (locomotive, locomotives, az_rms, 1.0 m/s^2),
               (passenger, passenger vehicles, ay_max, 2.5 m/s^2),
               (passenger, passenger vehicles, az_max, 2.5 m/s^2),
               (passenger, passenger vehicles, ay_qst, 1.5 m/s^2),
               (passenger, passenger vehicles, ay_rms, 0.5 m/s^2),
               (passenger, passenger vehicles, az_rms, 0.75 m/s^2),
               (freight, freight wagons with bogies, ay_max, 3.0 m/s^2),
               (freight, freight wagons with bogies, az_max, 5.0 m/s^2),
               (freight, freight wagons with bogies, ay_qst, 1.3 m/s^2),
               (freight, freight wagons with bogies, ay_rms, 1.3 m/s^2),
               (freight, freight wagons with bogies, az_rms, 2.0 m/s^2)
  default      {default}
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7, ride characteristics (partly informative)"

# ---- signal processing
parameter lowpass_frequency "Cut-off of the low-pass filter"
  default  20 Hz
  range    5 Hz to 60 Hz
  source   "EN 14363:2016, clause 7; public table of the GENSYS course"

parameter filter_phase "Filtering forward and backward, or causal"
  default  zero-phase
  one of   zero-phase, causal, causal-from-rest
  note     "The public table does not specify it; zero phase preserves the position of a peak."

place wheelset
  members  1, 2, 3, 4

place side
  members  R, L
  alias    outer is L when direction is right, R when direction is left
  alias    inner is R when direction is right, L when direction is left

place running_gear
  members  I, II

vehicle category "Vehicle category"
  one of  passenger, locomotive, freight

vehicle running_gear_type "Running gear"
  one of  bogies, single_axles
  key     running_gear

vehicle Q0 "Static vertical wheel force"
  in     kN
  key    static_wheel_load
  range  10 kN to 200 kN
  note   "Of one wheel. The range corresponds to axle loads from 2 t to 41 t. A value outside it is likely in"
         "another unit, or the load of an axle or of the vehicle."

vehicle admissible_speed "Admissible speed, which determines the length of sections"
  in        km/h
  optional  not assessable
  note      "On-track tests are run up to 1.1 times this speed."

vehicle bogie_mass "Mass of a bogie frame"
  in        kg
  key       bogie.mass
  optional  not assessable

vehicle wheelset_mass "Mass of a wheelset"
  in        kg
  key       wheelset.mass
  optional  not assessable

section zone "Test zone"
  one of  zones

section radius "Curve radius"
  in  m

section direction "Direction"
  one of  right, left, straight

section cant "Cant"
  in  mm

section cant_deficiency "Cant deficiency"
  in  mm

section speed "Speed"
  in  km/h

channel Y "Guiding force"
  in      kN
  at      each wheelset and side
  column  "Y_{wheelset}{side}"
  note    "Positive to the right of the running direction."

channel Q "Vertical wheel force"
  in      kN
  at      each wheelset and side
  column  "Q_{wheelset}{side}"

channel ay "Car body lateral acceleration"
  in      m/s^2
  at      each running_gear
  column  "ay_{running_gear}"

channel az "Car body vertical acceleration"
  in      m/s^2
  at      each running_gear
  column  "az_{running_gear}"

channel ayb "Lateral acceleration of the bogie frame"
  in      m/s^2
  at      each running_gear
  column  "ayb_{running_gear}"

channel curvature "Curvature of the track"
  in      1/m
  record  track

channel track_cant "Cant of the track"
  in      mm
  column  "cant"
  record  track

channel running_distance "Distance along the track"
  in      m
  column  "distance"

channel clock "Time of the samples"
  in      s
  column  "time"

signal YQ "Ratio Y/Q"
  is     Y / Q
  at     each wheelset and side
  in     -
  named  "YQ_{wheelset}{side}"
  note   "Calculated sample by sample."

signal kYQ_left "Ratio Y/Q of the left wheel, positive towards its flange"
  is     -YQ at side L
  at     each wheelset
  in     -
  named  "kYQ_{wheelset}L"

signal kYQ_right "Ratio Y/Q of the right wheel, positive towards its flange"
  is     YQ at side R
  at     each wheelset
  in     -
  named  "kYQ_{wheelset}R"

signal SigmaY "Sum of guiding forces"
  is     Y at side R + Y at side L
  at     each wheelset
  in     kN
  named  "SigmaY_{wheelset}"

signal SigmaQ "Sum of the vertical wheel forces of a wheelset"
  is     Q at side R + Q at side L
  at     each wheelset
  in     kN
  named  "SigmaQ_{wheelset}"

signal DeltaQ "Difference of left and right vertical wheel force of a wheelset"
  is     Q at side L - Q at side R
  at     each wheelset
  in     kN
  named  "DeltaQ_{wheelset}"

signal TotalY "Sum of all guiding forces"
  is     SigmaY at wheelset 1 + SigmaY at wheelset 2 + SigmaY at wheelset 3 + SigmaY at wheelset 4
  in     kN
  named  "TotalY"

filter LP20 "Low-pass filter 20 Hz"
  step    low-pass lowpass_frequency, order 4, filter_phase
  source  "EN 14363:2016, clause 7; public table of the GENSYS course"

filter WINDOW "Sliding mean 2 m, step 0.5 m"
  step    sliding mean 2 m every 0.5 m
  source  "EN 14363:2016, clause 7; public table of the GENSYS course"

filter BP "Band-pass filter 0.4 to 10 Hz"
  step    band-pass 0.4 Hz to 10 Hz, order 4, filter_phase
  source  "EN 14363:2016, clause 7; public table of the GENSYS course"

filter RMS_100 "Sliding rms value over 100 m, step 10 m"
  step    sliding rms 100 m every 10 m, short-sections
  source  "EN 14363:2016, clause 7; window of 100 m: Goetz & Polach, section 3.4; step from memory"
  note    "A section shorter than 100 m is one window."

filter HUNTING "Band-pass filter around the frequency of the unstable motion"
  step    band-pass (hunting_frequency - instability_band) to (hunting_frequency + instability_band), order 4,
          filter_phase
  source  "EN 14363:2016, clause 7; public table of the GENSYS course"

define turn "1 in right-hand curves, -1 in left-hand curves"
  is  1 when direction is right, -1 when direction is left, otherwise 0

define unbalanced_acceleration "Lateral acceleration in the plane of the track, positive to the right"
  is    turn * (speed^2 / radius - 9.80665 m/s^2 * cant / 1500 mm)
  note  "1500 mm: distance of the contact points."

# ---- bounds
define SigmaY_max_limit "Limit of the sum of guiding forces"
  is  (sum_factor_freight when vehicle.category is freight, otherwise 1) * (sum_base + 2/3 * Q0)

define YQ_max_limit "Limit of Y/Q"
  is  YQ_limit

define SigmaY_instability_limit "Limit of the rms value of the sum of guiding forces"
  is  instability_share * SigmaY_max_limit

define ayb_rms_limit "Limit of the rms value of the bogie acceleration"
  is    (bogie_acceleration_base - bogie_acceleration_slope * (bogie_mass + 2 * wheelset_mass)) / 2
  note  "The mass of the bogie includes that of its wheelsets."

define Q_max_limit "Limit of the vertical wheel force"
  is  smaller of Q_base + Q0, (Q_cap_160 when admissible_speed <= 160 km/h, Q_cap_200
      when admissible_speed <= 200 km/h, Q_cap_250 when admissible_speed <= 250 km/h, Q_cap_300
      when admissible_speed <= 300 km/h, otherwise Q_cap_above)

define Q_qst_limit "Limit of the quasi-static vertical wheel force"
  is  Q_qst_limit_light when 2 * Q0 <= 225 kN, otherwise Q_qst_limit_heavy

define {value}_limit "Limit of {value}"
  for each  value in ay_max, az_max, ay_qst, ay_rms, az_rms
  is        {value}_limit_locomotive when vehicle.category is locomotive,
            {value}_limit_freight when vehicle.category is freight,
            otherwise {value}_limit_passenger

zone 1 "Straight track and very large radius curves"
  where             direction is straight or (radius > 600 m and |cant_deficiency| <= 40 mm)
  minimum sections  sections_per_zone
  minimum length    250 m when admissible_speed <= 220 km/h, otherwise 500 m
  unconfirmed       "Radii, cant deficiency and lengths of the zones from memory; the standard was not to"
                    "hand."
  source            "EN 14363:2016, clause 7. Lengths of 70 m to 500 m in all: Goetz & Polach, section 3.1"

zone 2 "Large radius curves"
  where             radius > 600 m
  minimum sections  sections_per_zone
  minimum length    100 m when admissible_speed <= 140 km/h,
                    250 m when admissible_speed <= 220 km/h,
                    otherwise 500 m
  unconfirmed       "Radii, cant deficiency and lengths of the zones from memory; the standard was not to"
                    "hand."
  source            "EN 14363:2016, clause 7"
  note              "No range of the cant deficiency is required."

zone 3 "Small radius curves"
  where             400 m <= radius <= 600 m
  minimum sections  sections_per_zone
  minimum length    100 m
  unconfirmed       "Radii, cant deficiency and lengths of the zones from memory; the standard was not to"
                    "hand."
  source            "EN 14363:2016, clause 7"

zone 4 "Very small radius curves"
  where             250 m <= radius < 400 m
  minimum sections  sections_per_zone
  minimum length    70 m
  unconfirmed       "Radii, cant deficiency and lengths of the zones from memory; the standard was not to"
                    "hand."
  source            "EN 14363:2016, clause 7. Length of 70 m: Goetz & Polach, section 3.1"

check full_curve "Section lies in full curve or on straight track"
  require    range of curvature <= 2 % * |mean of curvature| + 0.00001 1/m
  unchecked  note
  source     "Section 3.2"
  note       "Requires the track file; the tolerance is this protocol's own."

plausibility static_load "Vertical wheel force against the static load"
  of         SigmaQ at each wheelset
  require    median near 2 * Q0 within a factor of 1.4
  otherwise  not used
  cause      "the load of an axle, a bogie or the vehicle instead of that of a wheel; another load condition"
  note       "A payload adds up to one third; the smallest likely error, the load of an axle, is a factor of"
             "2."

plausibility load_transfer "Load transfer to the outer wheels"
  of         DeltaQ at each wheelset
  require    turn * median > -0.15 * Q0 - |median of TotalY + 8 * Q0 / 9.80665 m/s^2 * unbalanced_acceleration|
  unless     direction is straight or cant_deficiency < 60 mm
  otherwise  not used
  cause      "exchange of the left and the right wheel, or the direction of the curve"
  note       "With 60 mm of cant deficiency the outer wheel carries about 5 % more. A cross wind takes from"
             "it less than its own force, which the guiding forces show."

plausibility guiding_sign "Guiding force of the outer leading wheel"
  of         Y at wheelset 1 and side outer
  require    -turn * median > 0.08 * Q0
  unless     direction is straight or radius > 600 m
  otherwise  not used
  cause      "the sign of the guiding forces, their unit, or the direction of the curve"
  note       "In small curves the outer leading wheel guides: its guiding force is usually a quarter of the"
             "wheel load or more."

plausibility guiding_balance "Sum of the guiding forces against the unbalanced acceleration"
  of       TotalY
  require  median near -(8 * Q0 / 9.80665 m/s^2) * unbalanced_acceleration within 12 kN + 0.05 * 8 * Q0
  unless   direction is straight
  cause    "the sign or the unit of the guiding forces; a lateral load such as wind"
  note     "The sum of all guiding forces balances the unbalanced acceleration. The tolerance is about 1"
           "m/s^2 below the difference that an inverted sign causes at 100 mm of cant deficiency."

plausibility wheel_climb "Ratio Y/Q below the limit of flange climbing"
  of         YQ at each wheelset and side
  require    |median| <= 1.2
  otherwise  not used
  cause      "the unit of the guiding or of the vertical forces"
  note       "Flange climbing begins at about 1.2 for a flange angle of 70 degrees (Nadal's limit); no"
             "quasi-static value is close to it."

plausibility lateral_acceleration "Lateral acceleration against the unbalanced acceleration"
  of         ay at each running_gear
  require    median near 1.2 * unbalanced_acceleration within 0.2 m/s^2 + 0.4 * 1.2 * |unbalanced_acceleration|
  unless     direction is straight
  otherwise  not used
  cause      "the sign or the unit of the acceleration; cant, radius or speed of the section"
  note       "A sensor fixed to the body measures the unbalanced acceleration plus the component of gravity"
             "due to the roll of the body, a fifth to a third of it."

plausibility acceleration_level "Level of the car body accelerations"
  of         ay at each running_gear
  of         az at each running_gear
  filter     BP
  require    0.01 m/s^2 <= rms and rms <= 2 m/s^2
  otherwise  not used
  cause      "the unit of the acceleration, g instead of m/s^2; a sensor without a signal"
  note       "The bounds are this protocol's own: an eighth of the value of a coach on good track, and twice"
             "the value of a locomotive on poor track."

plausibility running_speed "Speed from distance and time against the table of sections"
  require    range of running_distance / range of clock near speed within 3 %
  concerns   record
  otherwise  not used
  cause      "the clock, the scale of the distance, or the speed of the table"
  note       "A section is run at constant speed. A table with nominal speeds may be off by 2 km/h."

plausibility clock "Speed from distance and time against the table, over all sections"
  require   range of running_distance / range of clock near speed within 10 km/h
  over      sections
  slope     0.985 to 1.015
  concerns  record
  cause     "the clock or the scale of the distance of one of the records, or the speeds of the table"
  note      "Single sections may be run a little off the speed of the table; all together are not."

plausibility test_speed "Speed of the table against the admissible speed"
  require    speed <= 1.1 * admissible_speed + 10 km/h
  otherwise  not assessable
  cause      "the admissible speed of the vehicle file, or the speeds of the table of sections"
  note       "The test speed is at most 1.1 times the admissible one; 10 km/h are allowed for the run. The"
             "length of the sections depends on the admissible speed."

plausibility table_of_curves "Cant deficiency against speed, radius and cant"
  require    |cant_deficiency| near |1500 mm * (speed^2 / radius / 9.80665 m/s^2) - cant| within 15 mm
  concerns   record
  unless     direction is straight
  otherwise  not used
  cause      "radius, speed, cant or cant deficiency of the table of sections"

plausibility track_curvature "Curvature of the track file against radius and direction"
  require    mean of curvature near turn / radius within 3 %
  concerns   record
  unless     direction is straight
  otherwise  not used
  cause      "radius, direction or place of the section, or the track file of another section"

plausibility track_straight "Straight sections against the track file"
  require    |mean of curvature| <= 0.0002 1/m
  concerns   record
  unless     direction is not straight
  otherwise  not used
  cause      "direction or place of the section, or the track file of another section"

plausibility track_cant "Cant of the track file against the table"
  require    mean of track_cant near turn * cant within 15 mm
  concerns   record
  unless     direction is straight
  otherwise  not used
  cause      "cant or direction of the section, or the track file of another section"

plausibility single_axles "Running gear and wheelsets"
  of         SigmaY at wheelset 3
  require    not (vehicle.running_gear_type is single_axles)
  otherwise  not assessable
  cause      "the running gear of the vehicle file: a vehicle with single axles has two wheelsets"

sections
  use          sections
  zone         zone
  faulty       not used
  report       total_length in km for each zone
  report       mean_radius for each zone where direction is not straight
  report       mean_speed for each zone
  report       mean_cant_deficiency for each zone
  report       largest_cant_deficiency for each zone
  report       right_hand_curves for each zone where direction is not straight
  report       share_of_zone_1
  report       share_of_zone_2
  report       share_of_zone_3
  report       share_of_zone_4
  percentiles  linear

# ---- running safety
quantity SigmaY_max "Sum of guiding forces, maximum"
  symbol  "ΣY_max"
  of      SigmaY
  filter  LP20, then WINDOW
  from    measured
  value   -p0.15 when direction is not left
  value   p99.85 when direction is not right
  limit   safety at most SigmaY_max_limit for each zone and wheelset
  note    "In curves the end of the distribution towards the outside; on straight track both ends, as two"
          "values of one sample."

quantity YQ_max "Ratio Y/Q, maximum"
  symbol  "(Y/Q)_max"
  of      kYQ_left when direction is not left
  of      kYQ_right when direction is not right
  filter  LP20, then WINDOW
  from    measured
  value   p99.85
  limit   safety at most YQ_max_limit for each zone and wheelset
  note    "In curves the outer wheel; on straight track both wheels, each towards its own flange."

quantity SigmaY_instability "Instability: sum of guiding forces, rms value over 100 m"
  symbol  "ΣY_rms"
  of      SigmaY
  filter  HUNTING, then RMS_100
  from    measured
  value   maximum
  limit   safety at most SigmaY_instability_limit for each zone and wheelset

quantity ayb_rms "Instability: lateral acceleration of the bogie frame, rms value over 100 m"
  symbol  "ÿ+_rms"
  of      ayb
  filter  HUNTING, then RMS_100
  from    measured
  value   maximum
  limit   safety at most ayb_rms_limit for each zone and running_gear

# ---- track loading
quantity Q_max "Vertical wheel force, maximum"
  symbol  "Q_max"
  of      Q at side outer when direction is not straight
  of      Q when direction is straight
  filter  LP20
  from    measured
  value   p99.85
  limit   loading at most Q_max_limit for each zone and wheelset

quantity Y_qst "Guiding force, quasi-static"
  symbol  "Y_qst"
  of      Y at side outer when direction is not straight
  filter  LP20
  from    measured
  value   -turn * median
  limit   quasi_static Y_qst_base + Y_qst_radius / mean of radius for zone 4 and each wheelset
  limit   quasi_static Y_qst_limit_flat for zones 2, 3 and each zone and wheelset

quantity Q_qst "Vertical wheel force, quasi-static"
  symbol  "Q_qst"
  of      Q at side outer when direction is not straight
  filter  LP20
  from    measured
  value   median
  limit   quasi_static Q_qst_limit for each zone and wheelset where direction is not straight

quantity B_qst "Combined rail loading, quasi-static"
  symbol  "B_qst"
  of      Y at side outer when direction is not straight
  filter  LP20
  from    measured
  value   -turn * median + B_qst_share * median of Q at side outer through LP20
  limit   quasi_static B_qst_limit for each zone and wheelset where direction is not straight

# ---- ride
quantity ay_max "Lateral acceleration of the car body, maximum"
  symbol  "ÿ*_max"
  of      ay
  filter  BP
  from    measured
  value   p99.85 when direction is not left
  value   -p0.15 when direction is not right
  limit   loading at most ay_max_limit for each zone and running_gear

quantity az_max "Vertical acceleration of the car body, maximum"
  symbol  "z̈*_max"
  of      az
  filter  BP
  from    measured
  value   larger of |p0.15|, |p99.85|
  limit   loading at most az_max_limit for each zone and running_gear

quantity ay_rms "Lateral acceleration of the car body, rms value"
  symbol  "ÿ*_rms"
  of      ay
  filter  BP
  from    measured
  value   rms
  limit   loading at most ay_rms_limit for each zone and running_gear

quantity az_rms "Vertical acceleration of the car body, rms value"
  symbol  "z̈*_rms"
  of      az
  filter  BP
  from    measured
  value   rms
  limit   loading at most az_rms_limit for each zone and running_gear

quantity ay_qst "Lateral acceleration of the car body, quasi-static"
  symbol  "ÿ*_qst"
  of      ay when direction is not straight
  filter  LP20
  from    measured
  value   turn * median
  limit   quasi_static ay_qst_limit for each zone and running_gear where direction is not straight

# ---- estimates
estimate safety "Estimated maximum"
  is      mean + k_safety * std
  source  "EN 14363:2016, clause 7, one-dimensional method"

estimate loading "Estimated maximum"
  is      mean + k_loading * std
  source  "EN 14363:2016, clause 7, one-dimensional method"

estimate quasi_static "Mean value"
  is      mean
  source  "EN 14363:2016, clause 7, one-dimensional method"

# ---- the sections, without limits
estimate total_length "Total length"
  is  total of length

estimate mean_radius "Mean radius"
  is    mean of radius
  note  "Without sections on straight track."

estimate mean_speed "Mean speed"
  is  mean of speed

estimate mean_cant_deficiency "Mean cant deficiency"
  is  mean of cant_deficiency

estimate largest_cant_deficiency "Largest cant deficiency"
  is  maximum of cant_deficiency

estimate right_hand_curves "Share of right-hand curves"
  is  share of sections where direction is right

estimate share_of_zone_{zone_name} "Share of the sections in zone {zone_name}"
  for each  zone_name in 1, 2, 3, 4
  is        share of sections where zone is {zone_name}

# ---- verdicts
verdict
  validated           when every limit holds
  words               accepted, not accepted
  minimum signals     1
  minimum pairs       1
  standard deviation  n-1

verdict running_safety "Running safety"
  of     SigmaY_max, YQ_max
  holds  when every limit holds
  words  met, not met

verdict stability "Stability"
  of     SigmaY_instability, ayb_rms
  holds  when every limit holds
  words  met, not met

verdict track_loading "Track loading"
  of     Q_max, Y_qst, Q_qst, B_qst
  holds  when every limit holds
  words  met, not met

verdict ride "Ride characteristics"
  of     ay_max, az_max, ay_rms, az_rms, ay_qst
  holds  when every limit holds
  words  met, not met
