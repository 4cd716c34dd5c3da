# Forces of the railroad tests of a freight car, measured.

protocol aar-m1001-chapter-11 "Wheel forces of a freight car, measured, in the manner of AAR M-1001, chapter 11"
  uses        plausibility-signals
  edition     "AAR M-1001, chapter 11"
  source      "AAR M-1001, chapter 11: all limits from memory; the manual was not to hand"
  author      "Fishplate"
  scope       "What is exceeded for longer than 50 ms: L/V of a wheel, of an axle and of a side of a truck,"
              "and the vertical wheel load."
  axis        distance in m
  time        time in s
  leaves out  "Roll angle, accelerations, buff and draft, and the regimes of the tests."

parameter {name}_limit "{of}"
  for each     name, limit, of in (wheel, 1, "Largest L/V of a wheel"),
               (axle, 1.5, "Largest sum of L/V of an axle"),
               (truck_side, 0.6, "Largest L/V of a side of a truck"),
               (load, 0.1, "Least vertical wheel load, share of the static one")
  default      {limit}
  range        0.01 to 3
  unconfirmed  "From memory; editions differ; the manual was not to hand."

parameter duration "Longest time for which a criterion may be exceeded"
  default      50 ms
  range        10 ms to 500 ms
  unconfirmed  "From memory; the manual was not to hand."

parameter lowpass "Cut-off of the forces"
  default      15 Hz
  range        10 Hz to 40 Hz
  unconfirmed  "From memory; the manual was not to hand."

place wheelset
  members  1, 2, 3, 4

place side
  members  R, L

vehicle Q0 "Static vertical wheel load"
  in     kN
  key    static_wheel_load
  range  10 kN to 250 kN

channel Y "Lateral wheel force"
  in      kN
  at      each wheelset and side
  column  "Y_{wheelset}{side}"

channel Q "Vertical wheel force"
  in      kN
  at      each wheelset and side
  column  "Q_{wheelset}{side}"

signal wheel_lv "L/V of a wheel"
  is  |Y through LP| / (Q through LP)
  at  each wheelset and side
  in  -

signal axle_lv "Sum of L/V of an axle"
  is  |Y at side R through LP| / (Q at side R through LP) + |Y at side L through LP| / (Q at side L through LP)
  at  each wheelset
  in  -

signal truck_lv_{truck} "L/V of a side of truck {truck}"
  for each  truck, front, rear in (I, 1, 2), (II, 3, 4)
  is        |(Y at wheelset {front} + Y at wheelset {rear}) through LP| / ((Q at wheelset {front} + Q at wheelset {rear}) through LP)
  at        each side
  in        -

signal load_share "Vertical wheel load over the static one"
  is  (Q through LP) / Q0
  at  each wheelset and side
  in  -

filter LP "Low-pass of the forces"
  step  low-pass lowpass, order 4, zero-phase
  note  "Order and phase are this text's own."

filter LASTING "What is exceeded throughout the time"
  step  sliding minimum duration every sample

plausibility static_load "Vertical wheel force against the static load"
  of         Q
  require    median near Q0 within a factor of 1.6
  otherwise  not used
  cause      "the unit, or the load of an axle in place of that of a wheel"

sections
  use  whole records

quantity wheel "L/V of a wheel"
  of      wheel_lv
  filter  LASTING
  from    measured
  value   maximum
  limit   each wheel_limit

quantity axle "Sum of L/V of an axle"
  of      axle_lv
  filter  LASTING
  from    measured
  value   maximum
  limit   each axle_limit

quantity truck_side_{truck} "L/V of a side of truck {truck}"
  for each  truck in I, II
  of        truck_lv_{truck}
  filter    LASTING
  from      measured
  value     maximum
  limit     each truck_side_limit

quantity load "Least vertical wheel load, share of the static one"
  of      load_share
  filter  sliding maximum duration every sample
  from    measured
  value   minimum
  limit   each at least load_limit

verdict
  validated  when every limit holds
  words      meets the criteria, exceeds a criterion
