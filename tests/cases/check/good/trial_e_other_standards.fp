protocol trial-e-other-standards "Flexibility and wheel unloading on twisted track"
  axis  time in s

place side
  members  R, L

channel Q "Vertical wheel force"
  in      kN
  at      each side
  column  "Q_1{side}"

channel twist "Twist"
  in  mm

channel cant "Cant"
  in  mm

channel roll "Roll angle of the car body against the track"
  in  mrad

channel door "Distance of the gauging point from the track's middle"
  in  mm

parameter gauge "Distance of the contact points"
  default  1500 mm

signal cant_angle "Angle of the cant"
  is  asin(cant / gauge)
  in  mrad

signal unloading "Change of the wheel forces over their mean"
  is  (Q at side R - Q at side L) / (Q at side R + Q at side L)
  in  -

signal door_speed "Speed of the gauging point"
  is  derivative(door)
  in  mm/s

sections
  use  whole records

quantity flexibility "Flexibility coefficient: roll angle over angle of the cant"
  of          roll
  value       slope over cant_angle
  difference  (simulated - measured) / measured
  limit       each 10 %

quantity flexibility_measured "Flexibility coefficient of the measured vehicle"
  from   measured
  of     roll
  value  |slope over cant_angle|
  limit  each 0.4

quantity unloading_per_twist "Torsional stiffness: wheel unloading over twist"
  of          unloading
  value       slope over twist
  difference  (simulated - measured) / measured
  limit       each 10 %

quantity unloading_measured "Measured wheel unloading"
  from   measured
  of     unloading
  value  peak
  limit  each 0.6

quantity unloading_loop "Loop of the wheel unloading over twist, over its measured range"
  of      unloading
  metric  hysteresis_maximum(twist) / measured(range)
  limit   each 10 %

quantity door_speed_largest
  of          door_speed
  value       peak
  difference  signed
  limit       each 5 mm/s
