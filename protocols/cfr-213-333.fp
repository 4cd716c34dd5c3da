# Public law of the United States, in own words. Numbers to be checked against the edition in force.

protocol cfr-213-333 "Interaction of vehicle and track, measured, in the manner of 49 CFR 213.333"
  uses        plausibility-signals
  edition     "49 CFR 213.333, table of vehicle/track interaction safety limits, rule of 2013"
  source      "49 CFR 213.333, rule of 2013 (78 FR 16052). Limits, distances and windows from memory; filters"
              "as in the edition of 1998"
  author      "Fishplate"
  scope       "Wheel and truck forces over 5 ft, accelerations of the car body and the truck: each measured"
              "record as a whole."
  axis        distance in m
  time        time in s
  leaves out  "How often a vehicle is measured, what is done after an exceedance, and the limits of track"
              "geometry."
  note        "Check each number against the edition in force."
  note        "The category passenger has the limits of passenger cars, every other those of other vehicles."

parameter {name}_limit "{of}"
  for each     name, limit, low, high,
               of in (least_load, 0.15, 0.01, 1, "Least vertical wheel load, share of the static one"),
               (truck_side, 0.6, 0.1, 2, "Largest L/V of a side of a truck"), (lateral_peak_passenger,
               0.65 gn, 0.01 gn, 3 gn, "Car body lateral, peak to peak, passenger cars"),
               (lateral_peak_other, 0.75 gn, 0.01 gn, 3 gn, "Car body lateral, peak to peak, other vehicles"),
               (lateral_rms_passenger, 0.1 gn, 0.01 gn, 3 gn,
               "Car body lateral, rms about the trend, passenger cars"), (lateral_rms_other, 0.12 gn, 0.01 gn,
               3 gn, "Car body lateral, rms about the trend, other vehicles"), (vertical_peak_passenger, 1 gn,
               0.01 gn, 3 gn, "Car body vertical, peak to peak, passenger cars"), (vertical_peak_other,
               1.25 gn, 0.01 gn, 3 gn, "Car body vertical, peak to peak, other vehicles"),
               (vertical_rms, 0.25 gn, 0.01 gn, 3 gn, "Car body vertical, rms about the trend"),
               (truck_lateral, 0.3 gn, 0.01 gn, 3 gn, "Truck lateral, rms about the trend")
  default      {limit}
  range        {low} to {high}
  unconfirmed  "From memory; the edition in force was not to hand."

parameter friction "Friction in the limit of a single wheel"
  default  0.5
  range    0 to 1
  source   "The form with 0.5 was read in 49 CFR 238, Appendix C"

parameter net_axle_base "Limit of the net axle L/V for an infinite axle load"
  default      0.4
  range        0.1 to 1
  unconfirmed  "From memory; the edition in force was not to hand."

parameter net_axle_load "Load over which the limit of the net axle L/V grows by 1"
  default      5000 lbf
  range        0 lbf to 50000 lbf
  unconfirmed  "From memory; the edition in force was not to hand."

parameter stretch "Distance throughout which a force counts"
  default      5 ft
  range        1 ft to 20 ft
  unconfirmed  "From memory; 5 ft was read in 49 CFR 238, Appendix C."

parameter {name}_window "{of}"
  for each     name, window, of in (transient, 1 s, "Window of peak-to-peak accelerations"),
               (body, 4 s, "Window of the rms of the car body"),
               (truck, 2 s, "Window of the rms of the truck")
  default      {window}
  range        0.5 s to 10 s
  unconfirmed  "From memory; the edition in force was not to hand."

parameter short_peak "Duration below which a peak of a car body acceleration is left out"
  default      50 ms
  range        10 ms to 200 ms
  unconfirmed  "From memory; 50 ms was read in 49 CFR 299.313."

parameter sustained "What a sustained oscillation is"
  default      window
  one of       window, throughout
  unconfirmed  "From memory. `window`: the rms of one window above the limit; `throughout`: the rms of all"
               "windows that begin within a further window. The first is the stricter one."

parameter body_lowpass "Cut-off of the car body accelerations"
  default      10 Hz
  range        5 Hz to 40 Hz
  unconfirmed  "From memory; `at least 10 Hz` was read in 49 CFR 299.313."

place wheelset
  members  1, 2, 3, 4

place side
  members  R, L

place running_gear
  members  I, II

vehicle Q0 "Static vertical wheel load"
  in     kN
  key    static_wheel_load
  range  10 kN to 250 kN

vehicle category "Category"
  one of  passenger, locomotive, freight

vehicle flange_angle "Flange angle of the wheels"
  in     deg
  range  55 deg to 80 deg

channel Y "Lateral wheel force"
  in      kN
  at      each wheelset and side
  column  "Y_{wheelset}{side}"

channel Q "Vertical wheel force"
  in      kN
  at      each wheelset and side
  column  "Q_{wheelset}{side}"

channel ay "Lateral acceleration of the car body near its ends, at floor level"
  in      m/s^2
  at      each running_gear
  column  "ay_{running_gear}"

channel az "Vertical acceleration of the car body near its ends, at floor level"
  in      m/s^2
  at      each running_gear
  column  "az_{running_gear}"

channel ayb "Lateral acceleration of the truck frame"
  in        m/s^2
  at        each running_gear
  column    "ayb_{running_gear}"
  optional  not assessed

signal wheel_lv "L/V of a wheel"
  is  |Y through LP25| / (Q through LP25)
  at  each wheelset and side
  in  -

signal net_lv "Net lateral force of an axle over its static load"
  is  |(Y at side R + Y at side L) through LP25| / (2 * Q0)
  at  each wheelset
  in  -

signal truck_lv_{truck} "L/V of a side of truck {truck}"
  for each  truck, front, rear in (I, 1, 2), (II, 3, 4)
  is        |(Y at wheelset {front} + Y at wheelset {rear}) through LP25| / ((Q at wheelset {front} + Q at wheelset {rear}) through LP25)
  at        each side
  in        -

signal load_share "Vertical wheel load over the static one"
  is  (Q through LP25) / Q0
  at  each wheelset and side
  in  -

filter LP25 "Low-pass of the forces"
  step        low-pass 25 Hz, order 4, zero-phase
  clause      "49 CFR 213.333, processing of wheel forces"
  paraphrase  "Wheel forces are low-pass filtered at 25 Hz or more."
  source      "49 CFR 213.333, edition of 1998: at least 25 Hz. Order and phase are this text's own"

filter OVER_STRETCH "What is exceeded throughout the distance"
  step  sliding minimum stretch every sample

filter BODY "Low-pass of the car body accelerations"
  step  low-pass body_lowpass, order 4, zero-phase
  note  "Order and phase are this text's own."

filter WITHOUT_SHORT_PEAKS "Peaks upward, then downward, shorter than the duration are cut off"
  step  sliding minimum short_peak every sample
  step  sliding maximum (2 * short_peak) every sample
  step  sliding minimum short_peak every sample

filter BODY_RMS "Running rms about the trend, car body"
  step  BODY
  step  sliding rms_about_trend body_window every sample
  step  sliding minimum body_window every sample when sustained is throughout

filter TRUCK_RMS "Running rms about the trend, truck"
  step        band-pass 0.5 Hz to 10 Hz, order 4, zero-phase
  step        sliding rms_about_trend truck_window every sample
  step        sliding minimum truck_window every sample when sustained is throughout
  clause      "49 CFR 213.333, processing of truck accelerations"
  paraphrase  "Truck lateral accelerations are band-pass filtered from 0.5 Hz to 10 Hz."
  source      "49 CFR 213.333, edition of 1998: 0.5 Hz to 10 Hz. Order and phase are this text's own"

define single_wheel_limit "Limit of a single wheel, by the flange angle"
  is  (tan(flange_angle) - friction) / (1 + friction * tan(flange_angle))

plausibility static_load "Vertical wheel force against the static load"
  of         Q
  require    median near Q0 within a factor of 1.6
  otherwise  not used
  cause      "the unit, or the load of an axle in place of that of a wheel"
  note       "Curves move less than half of a wheel load to the other side."

plausibility gravity "Accelerations without the acceleration of gravity"
  of       ay
  of       az
  require  |median| <= 0.5 gn
  cause    "an accelerometer whose offset was not removed"

sections
  use  whole records

quantity wheel_load "Least vertical wheel load, share of the static one"
  of          load_share
  filter      sliding maximum stretch every sample
  from        measured
  value       minimum
  limit       each at least least_load_limit
  clause      "49 CFR 213.333, table, single wheel vertical load"
  paraphrase  "No wheel carries less than 0.15 of its static load throughout 5 ft."

quantity single_wheel "L/V of a wheel"
  of          wheel_lv
  filter      OVER_STRETCH
  from        measured
  value       maximum
  limit       each single_wheel_limit
  clause      "49 CFR 213.333, table, single wheel L/V"
  paraphrase  "The limit follows from the flange angle and a friction of 0.5; beyond it for less than 5 ft"
              "does not count."

quantity net_axle "Net lateral force of an axle over its static load"
  of          net_lv
  filter      OVER_STRETCH
  from        measured
  value       maximum
  limit       each net_axle_base + net_axle_load / (2 * Q0)
  clause      "49 CFR 213.333, table, net axle lateral L/V"
  paraphrase  "The sum of both lateral forces over the static axle load, with a limit that grows as the load"
              "falls."

quantity truck_side_{truck} "L/V of a side of truck {truck}"
  for each    truck in I, II
  of          truck_lv_{truck}
  filter      OVER_STRETCH
  from        measured
  value       maximum
  limit       each truck_side_limit
  clause      "49 CFR 213.333, table, truck side L/V"
  paraphrase  "The lateral forces of one side of a truck over its vertical forces stay within 0.6 throughout"
              "5 ft."

quantity body_{direction}_peak "Car body {direction}, peak to peak in any window"
  for each    direction, channel in (lateral, ay), (vertical, az)
  of          {channel}
  filter      BODY, then WITHOUT_SHORT_PEAKS, then sliding range transient_window every sample
  from        measured
  value       maximum
  limit       each {direction}_peak_passenger_limit when category is passenger,
              otherwise {direction}_peak_other_limit
  clause      "49 CFR 213.333, table, carbody, transient"
  paraphrase  "The car body stays within a peak-to-peak acceleration in any second; peaks shorter than 50 ms"
              "do not count."

quantity body_lateral_rms "Car body lateral, sustained oscillation"
  of          ay
  filter      BODY_RMS
  from        measured
  value       maximum
  limit       each lateral_rms_passenger_limit when category is passenger, otherwise lateral_rms_other_limit
  clause      "49 CFR 213.333, table, carbody lateral, sustained oscillatory"
  paraphrase  "The rms about the linear trend over 4 s stays within the limit."

quantity body_vertical_rms "Car body vertical, sustained oscillation"
  of          az
  filter      BODY_RMS
  from        measured
  value       maximum
  limit       each vertical_rms_limit
  clause      "49 CFR 213.333, table, carbody vertical, sustained oscillatory"
  paraphrase  "The rms about the linear trend over 4 s stays within the limit."

quantity truck_lateral "Truck lateral, sustained oscillation"
  of          ayb
  filter      TRUCK_RMS
  from        measured
  value       maximum
  limit       each truck_lateral_limit
  clause      "49 CFR 213.333, table, truck lateral"
  paraphrase  "The rms about the linear trend over 2 s stays within the limit."

clause sampling "Wheel forces are recorded with 250 samples a second or more"
  clause     "49 CFR 213.333, sampling"
  judged by  "the person in charge of the measuring system"
  note       "Read in the edition of 1998."

clause sensors "Accelerometers of the car body are near its ends at floor level"
  clause     "49 CFR 213.333, place of the accelerometers"
  judged by  "the person in charge of the measuring system"
  note       "Read in the edition of 1998."

clause intervals "The vehicle is measured again at intervals, by the class of the track"
  clause  "49 CFR 213.333, intervals of measurement"
  note    "From memory."

clause after_exceedance "What is done with a track or a vehicle after an exceedance"
  clause  "49 CFR 213.333, action after an exceedance"
  note    "From memory."

clause qualification "A vehicle is qualified up to 10 mph above the speed that is asked for"
  clause     "49 CFR 213.345"
  judged by  "the person in charge of the qualification"
  note       "Read in the edition of 2006."

clause simulations "Simulations on track at the limits of its class; the model is validated by predictions on measured track geometry"
  clause     "49 CFR 213, Appendix D"
  judged by  "the person in charge of the qualification"

verdict
  validated  when every limit holds
  words      within the limits, beyond a limit
