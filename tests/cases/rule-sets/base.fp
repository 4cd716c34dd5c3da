protocol rail-base "Signals of a bogie vehicle"
  axis  distance in m
  time  time in s

place wheelset
  members  1, 2, 3, 4

place side
  members  R, L
  alias    outer is L when direction is right, R when direction is left
  alias    inner is R when direction is right, L when direction is left

place running_gear
  members  I, II

vehicle Q0 "Static wheel load"
  in     kN
  key    static_wheel_load
  range  10 kN to 200 kN

vehicle category "Category"
  one of  passenger, locomotive, freight

section zone "Zone"
  one of  zones

section radius "Radius"
  in  m

section direction "Direction"
  one of  right, left, straight

section cant_deficiency "Cant deficiency"
  in  mm

section speed "Speed"
  in  km/h

channel Y "Guiding force"
  in  kN
  at  each wheelset and side

channel Q "Vertical wheel force"
  in  kN
  at  each wheelset and side

channel ay "Lateral acceleration of the car body"
  in  m/s^2
  at  each running_gear

channel az "Vertical acceleration of the car body"
  in  m/s^2
  at  each running_gear

channel ayb "Lateral acceleration of the bogie frame"
  in  m/s^2
  at  each running_gear

channel clock "Time"
  in      s
  column  "time"

signal YQ "Ratio Y/Q"
  is  Y / Q
  at  each wheelset and side
  in  -

signal SigmaY "Sum of guiding forces"
  is  Y at side R + Y at side L
  at  each wheelset
  in  kN

filter LP20 "Low-pass 20 Hz"
  step  low-pass 20 Hz, order 4, zero-phase

zone 1 "Straight"
  where  direction is straight or radius > 2500 m

zone 2 "Large radius"
  where  radius > 600 m

zone 3 "Small radius"
  where  400 m <= radius <= 600 m

zone 4 "Very small radius"
  where  radius < 400 m

sections
  use   sections
  zone  zone
