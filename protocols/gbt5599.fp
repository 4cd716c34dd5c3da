# A grade of the ride, and limits of running safety, of the measured vehicle.

protocol gbt5599 "Dynamic performance of a vehicle, measured, in the manner of GB/T 5599"
  uses        plausibility-signals
  edition     "GB/T 5599-2019"
  source      "GB/T 5599-2019: limits and grades from memory; the standard was not to hand"
  author      "Fishplate"
  scope       "Sperling's ride index with its grades; derailment coefficient, wheel unloading and lateral"
              "force of an axle with their limits."
  axis        distance in m
  time        time in s
  leaves out  "The ride index by the lines of a spectrum, and its sum of tenth powers. Here the whole signal"
              "passes the weighting, as ERRI B153 writes it."
  leaves out  "The lateral stability by the acceleration of the frame."

parameter {grade}_{class} "Largest ride index that is {grade}, {class}"
  for each     grade, class, index in (excellent, coach, 2.5), (good, coach, 2.75), (qualified, coach, 3),
               (excellent, locomotive, 2.75), (good, locomotive, 3.1), (qualified, locomotive, 3.45),
               (excellent, wagon, 3.5), (good, wagon, 4), (qualified, wagon, 4.25)
  default      {index}
  range        1 to 6
  unconfirmed  "From memory; the standard was not to hand."

parameter {name} "{of}"
  for each     name, limit, of in (derailment_limit, 0.8, "Limit of the derailment coefficient"),
               (derailment_limit_small, 1, "Limit of the derailment coefficient in small radii"),
               (unloading_limit, 0.65, "Limit of the wheel unloading"),
               (axle_factor, 1, "Factor on the limit of the lateral force of an axle")
  default      {limit}
  range        0.1 to 2
  unconfirmed  "From memory; the standard was not to hand."

parameter small_radius "Radius up to which the limit of small radii holds"
  default      400 m
  range        100 m to 1000 m
  unconfirmed  "From memory; the standard was not to hand."

parameter lowpass "Cut-off of the forces"
  default      40 Hz
  range        10 Hz to 90 Hz
  unconfirmed  "From memory; the standard was not to hand."

place wheelset
  members  1, 2, 3, 4

place side
  members  R, L

place running_gear
  members  I, II

vehicle category "Category"
  one of  passenger, locomotive, freight

vehicle Q0 "Static vertical wheel load"
  in     kN
  key    static_wheel_load
  range  10 kN to 250 kN

section radius "Radius"
  in  m

section direction "Direction"
  one of  right, left, straight

channel Y "Lateral wheel force"
  in      kN
  at      each wheelset and side
  column  "Y_{wheelset}{side}"

channel Q "Vertical wheel force"
  in      kN
  at      each wheelset and side
  column  "Q_{wheelset}{side}"

channel ay "Lateral acceleration of the car body"
  in      m/s^2
  at      each running_gear
  column  "ay_{running_gear}"

channel az "Vertical acceleration of the car body"
  in      m/s^2
  at      each running_gear
  column  "az_{running_gear}"

signal derail "Derailment coefficient"
  is  |Y through low-pass lowpass| / (Q through low-pass lowpass)
  at  each wheelset and side
  in  -

signal unload "Wheel unloading"
  is  1 - (Q through low-pass lowpass) / Q0
  at  each wheelset and side
  in  -

signal axle "Lateral force of an axle"
  is  (Y at side R + Y at side L) through low-pass lowpass
  at  each wheelset
  in  kN

filter SPERLING_{direction} "Weighting of the {direction} acceleration"
  for each  direction, gain in (lateral, 0.73730811351602), (vertical, 0.5882458219096603)
  step      transfer function pole 0.7236876838804673 Hz zero 0 Hz, gain {gain}
  step      transfer function poles 6.127742397935874 Hz quality 0.9006768282515845 zero 5.52955694427682 Hz
  source    "The weighting of ERRI B153 as rational function: 0.737 (lateral) or 0.588 (vertical) times the"
            "root of (1.911 f^2 + (0.25 f^2)^2) / ((1 - 0.277 f^2)^2 + (1.563 f - 0.0368 f^3)^2), in poles"
            "and zeros"

filter OVER_2M "Sliding mean"
  step  sliding mean 2 m every 0.5 m

define index_limit_{grade} "Ride index that is {grade}"
  for each  grade in excellent, good, qualified
  is        {grade}_coach when category is passenger,
            {grade}_locomotive when category is locomotive,
            otherwise {grade}_wagon

plausibility gravity "Accelerations without the acceleration of gravity"
  of       ay
  of       az
  require  |median| <= 5 m/s^2
  cause    "an accelerometer whose offset was not removed"

sections
  use  sections

quantity ride_{direction} "Ride index, {direction}"
  for each  direction, channel in (lateral, ay), (vertical, az)
  of        {channel}
  filter    SPERLING_{direction}
  from      measured
  value     4.42 * (rms / (1 m/s^2))^0.3
  outcome   excellent: holds when maximum <= index_limit_excellent
  outcome   good: holds when maximum <= index_limit_good
  outcome   qualified: holds when maximum <= index_limit_qualified
  outcome   unqualified: fails
  in        -

quantity derailment "Derailment coefficient"
  of      derail
  filter  OVER_2M
  from    measured
  value   maximum
  limit   each derailment_limit_small when direction is not straight and radius <= small_radius,
          otherwise derailment_limit

quantity unloading "Wheel unloading"
  of      unload
  filter  OVER_2M
  from    measured
  value   maximum
  limit   each unloading_limit

quantity axle_lateral "Lateral force of an axle"
  of      axle
  filter  OVER_2M
  from    measured
  value   peak
  limit   each axle_factor * (15 kN + 2 * Q0 / 3)

verdict
  validated  when safety holds and ride holds

verdict safety "Running safety"
  of     derailment, unloading, axle_lateral
  holds  when every limit holds

verdict ride "Ride"
  of     ride_lateral, ride_vertical
  holds  when every limit holds
  words  qualified, unqualified
