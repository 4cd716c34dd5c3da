protocol aar-m1001-ch11 "AAR M-1001 Chapter 11 style limits, simulated and measured"
  extends  "base.fp"
  scope    "No criterion may be exceeded for longer than 50 ms."

parameter window "Longest time for which a criterion may be exceeded"
  default  50 ms

parameter lv_limit "Single wheel L/V"
  default  1

parameter sum_limit "Axle sum L/V"
  default  1.5

parameter load_limit "Smallest vertical wheel load, share of the static load"
  default  5 %

channel roll "Roll angle of the car body"
  in        deg
  at        each running_gear
  optional  not assessed

signal lv_axle "Axle sum of |L/V|"
  is  |Y at side R / Q at side R| + |Y at side L / Q at side L|
  at  each wheelset
  in  -

signal over_single "1 where |L/V| is above its limit, otherwise 0"
  is  1 when |YQ| >= lv_limit, otherwise 0
  at  each wheelset and side
  in  -

signal over_sum "1 where the axle sum is above its limit"
  is  1 when lv_axle >= sum_limit, otherwise 0
  at  each wheelset
  in  -

signal load_share "Wheel load over static load"
  is  Q / Q0
  at  each wheelset and side
  in  %

quantity single_wheel "Single wheel L/V: largest share of a 50 ms window above the limit"
  of      over_single
  filter  sliding mean window every 5 ms
  from    measured
  value   maximum
  limit   each 99.9 %

quantity axle_sum "Axle sum L/V: largest share of a 50 ms window above the limit"
  of      over_sum
  filter  sliding mean window every 5 ms
  from    measured
  value   maximum
  limit   each 99.9 %

quantity axle_sum_mean "Axle sum L/V, largest 50 ms mean"
  of      lv_axle
  filter  sliding mean window every 5 ms
  from    measured
  value   maximum
  limit   each sum_limit

quantity axle_sum_3ft "Axle sum L/V, largest 3 ft mean"
  of      lv_axle
  filter  sliding mean 3 ft every 0.5 ft
  from    measured
  value   maximum
  limit   each sum_limit

quantity min_load "Smallest vertical wheel load, 3 ft mean"
  of      load_share
  filter  sliding mean 3 ft every 0.5 ft
  from    measured
  value   minimum
  limit   each at least load_limit

quantity roll_pp "Roll angle, peak to peak"
  of     roll
  from   measured
  value  range
  limit  each 6 deg

verdict forces "Criteria of the forces"
  of     single_wheel, axle_sum, axle_sum_mean, axle_sum_3ft, min_load
  holds  when every limit holds
  words  meets Chapter 11, exceeds Chapter 11

verdict roll_verdict "Criterion of the roll angle"
  of     roll_pp
  holds  when every limit holds
