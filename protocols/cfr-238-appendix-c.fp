# Public law of the United States, in own words. Numbers to be checked against the edition in force.

protocol cfr-238-appendix-c "Suspension system of Tier II equipment, measured on track, in the manner of 49 CFR 238, Appendix C"
  uses        plausibility-signals
  edition     "49 CFR 238, Appendix C"
  source      "49 CFR 238, Appendix C; read in a public copy in 2026"
  author      "Fishplate"
  scope       "Wheel and truck forces over the time to travel 5 ft: each measured record as a whole."
  axis        distance in m
  time        time in s
  leaves out  "The stationary test on superelevation: `cfr-238-appendix-c-stationary`."
  leaves out  "The acceptance test of 49 CFR 238.427, and the accelerations of a car body."
  note        "Check each number against the edition in force."

parameter {name}_limit "{of}"
  for each  name, limit, of in (load, 0.1, "Wheel load must be above this share of the static one"),
            (side_load, 0.2, "Load of a truck side must be above this share of the static axle load"),
            (net_axle, 0.5, "Net lateral force of an axle, share of its static load"),
            (truck_side, 0.6, "L/V of a side of a truck")
  default   {limit}
  range     0.01 to 2

parameter friction "Friction in the limit of a single wheel"
  default  0.5
  range    0 to 1

parameter stretch "Distance throughout which a force counts"
  default  5 ft
  range    1 ft to 20 ft

place wheelset
  members  1, 2, 3, 4

place side
  members  R, L

vehicle Q0 "Static vertical wheel load"
  in     kN
  key    static_wheel_load
  range  10 kN to 250 kN

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

signal side_share_{truck} "Vertical load of a side of truck {truck} over the static axle load"
  for each  truck, front, rear in (I, 1, 2), (II, 3, 4)
  is        ((Q at wheelset {front} + Q at wheelset {rear}) through LP25) / (2 * Q0)
  at        each side
  in        -

filter LP25 "Low-pass of the forces"
  step  low-pass 25 Hz, order 4, zero-phase
  note  "Order and phase are this text's own."

filter OVER_STRETCH "What is exceeded throughout the distance"
  step  sliding minimum stretch every sample

define single_wheel_limit "Limit of a single wheel, by the flange angle"
  is  (tan(flange_angle) - friction) / (1 + friction * tan(flange_angle))

plausibility static_load "Vertical wheel force against the static load"
  of         Q
  require    median near Q0 within a factor of 1.6
  otherwise  not used
  cause      "the unit, or the load of an axle in place of that of a wheel"
  note       "Curves move less than half of a wheel load to the other side."

sections
  use  whole records

quantity single_wheel "L/V of a wheel"
  of          wheel_lv
  filter      OVER_STRETCH
  from        measured
  value       maximum
  limit       each single_wheel_limit
  clause      "49 CFR 238, Appendix C, single wheel L/V"
  paraphrase  "The limit of Nadal with a friction of 0.5, over the time to travel 5 ft."

quantity net_axle "Net lateral force of an axle over its static load"
  of          net_lv
  filter      OVER_STRETCH
  from        measured
  value       maximum
  limit       each net_axle_limit
  clause      "49 CFR 238, Appendix C, net axle lateral force"
  paraphrase  "The net lateral force of an axle stays within half of its static load."

quantity wheel_load "Least vertical wheel load, share of the static one"
  of          load_share
  filter      sliding maximum stretch every sample
  from        measured
  value       minimum
  limit       each at least load_limit
  clause      "49 CFR 238, Appendix C, vertical wheel load"
  paraphrase  "No wheel carries less than a tenth of its static load."

quantity side_load_{truck} "Least vertical load of a side of truck {truck}, share of the static axle load"
  for each    truck in I, II
  of          side_share_{truck}
  filter      sliding maximum stretch every sample
  from        measured
  value       minimum
  limit       each at least side_load_limit
  clause      "49 CFR 238, Appendix C, vertical load of one side of a truck"
  paraphrase  "Both wheels of one side together carry more than 0.20 of the static axle load."

quantity truck_side_{truck} "L/V of a side of truck {truck}"
  for each    truck in I, II
  of          truck_lv_{truck}
  filter      OVER_STRETCH
  from        measured
  value       maximum
  limit       each truck_side_limit
  clause      "49 CFR 238, Appendix C, truck side L/V"
  paraphrase  "The lateral forces of one side of a truck over its vertical forces stay within 0.6."

clause at_rest "At rest on 6 in of superelevation each wheel carries more than 0.60 of its load on level track"
  clause     "49 CFR 238, Appendix C, stationary test"
  judged by  "the person in charge of that test: protocol cfr-238-appendix-c-stationary"

clause acceptance "Accelerations of the car body in service and in the acceptance test"
  clause  "49 CFR 238.427"

verdict
  validated  when every limit holds
  words      within the limits, beyond a limit
