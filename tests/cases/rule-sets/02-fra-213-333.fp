protocol fra-213-333 "FRA 49 CFR 213.333 style vehicle/track interaction limits, measured"
  axis  distance in m
  time  time in s

parameter window "Window of the transient accelerations"
  default  1 s

parameter stretch "Distance throughout which a force counts"
  default  5 ft

parameter WT "Window of the truck acceleration"
  default  2 s

place wheelset
  members  1, 2, 3, 4

place side
  members  R, L

place running_gear
  members  I, II

vehicle Q0 "Static wheel load"
  in   kN
  key  static_wheel_load

channel Y "Guiding force"
  in  kN
  at  each wheelset and side

channel Q "Vertical wheel force"
  in  kN
  at  each wheelset and side

channel ay "Carbody lateral"
  in  m/s^2
  at  each running_gear

channel az "Carbody vertical"
  in  m/s^2
  at  each running_gear

channel ayb "Truck frame lateral"
  in  m/s^2
  at  each running_gear

signal net_axle "Net axle lateral L/V"
  is  |Y at side R + Y at side L| / (2 * Q0)
  at  each wheelset
  in  -

signal wheel_lv "Single wheel L/V"
  is  |Y| / Q
  at  each wheelset and side

signal truck_side "Truck side L/V, truck I"
  is  |Y at wheelset 1 + Y at wheelset 2| / (Q at wheelset 1 + Q at wheelset 2)
  at  each side
  in  -

filter LP10 "Low-pass 10 Hz"
  step  low-pass 10 Hz, order 4, zero-phase

sections
  use  whole records

quantity net_axle_lv "Net axle lateral L/V"
  of      net_axle
  filter  low-pass 25 Hz, then sliding minimum stretch every sample
  from    measured
  value   maximum
  limit   each 0.4 + 5 / (2 * Q0 / (1000 lbf))

quantity single_wheel_lv "Single wheel L/V"
  of      wheel_lv
  filter  sliding minimum stretch every sample
  from    measured
  value   maximum
  limit   each 0.82

quantity min_load "Least wheel load throughout the distance"
  of      Q
  filter  low-pass 25 Hz, then sliding maximum stretch every sample
  from    measured
  value   minimum / Q0
  limit   each at least 0.15

quantity truck_side_lv
  of      truck_side
  filter  sliding minimum stretch every sample
  from    measured
  value   maximum
  limit   each 0.6

quantity carbody_lateral "Car body lateral, peak to peak"
  of      ay
  filter  LP10, then sliding range window every sample
  from    measured
  value   maximum
  limit   each 0.65 gn

quantity truck_lateral "Truck lateral, rms about the trend"
  of      ayb
  filter  LP10, then sliding rms_about_trend WT every sample
  from    measured
  value   maximum
  limit   each 0.3 gn
