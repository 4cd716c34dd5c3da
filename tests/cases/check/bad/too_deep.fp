protocol small "A protocol for trials"
  axis  distance in m
  time  time in s

place wheelset
  members  1, 2

place side
  members  R, L
  alias    outer is L when direction is right, R when direction is left

place running_gear
  members  I, II

vehicle category "Vehicle category"
  one of  passenger, freight

vehicle Q0 "Static wheel force"
  in  kN

section zone "Test zone"
  one of  zones

section radius "Curve radius"
  in  m

section direction "Direction"
  one of  right, left, straight

channel Y "Guiding force"
  in      kN
  at      each wheelset and side
  column  "Y_{wheelset}{side}"

channel ay "Lateral acceleration"
  in  m/s^2
  at  each running_gear

channel curvature "Curvature"
  in      1/m
  record  track

filter LP20 "Low-pass filter"
  step  low-pass 20 Hz, order 4

zone 1 "Straight track"
  where  direction is straight

zone 2 "Curves"
  where  direction is not straight

sections
  zone  zone

quantity x0
  of          Y at wheelset 1
  value       median
  difference  signed
  limit       std ((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((1 kN))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))))

quantity x1
  of          Y at wheelset 1
  value       median
  difference  signed
  limit       std 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN + 1 kN

define d
  is  not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not not direction is straight

define e0
  is  1 kN + Q0

define e1
  is  e0 + e0

define e2
  is  e1 + e1

define e3
  is  e2 + e2

define e4
  is  e3 + e3

define e5
  is  e4 + e4

define e6
  is  e5 + e5

define e7
  is  e6 + e6

define e8
  is  e7 + e7

define e9
  is  e8 + e8

define e10
  is  e9 + e9

define e11
  is  e10 + e10

define e12
  is  e11 + e11

define e13
  is  e12 + e12

define e14
  is  e13 + e13

define e15
  is  e14 + e14

define e16
  is  e15 + e15

define e17
  is  e16 + e16

define e18
  is  e17 + e17

define e19
  is  e18 + e18

define e20
  is  e19 + e19

define e21
  is  e20 + e20

define e22
  is  e21 + e21

define e23
  is  e22 + e22

define e24
  is  e23 + e23

define e25
  is  e24 + e24

define e26
  is  e25 + e25

define e27
  is  e26 + e26

define e28
  is  e27 + e27

define e29
  is  e28 + e28

