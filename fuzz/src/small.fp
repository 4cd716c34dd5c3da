protocol fuzzed "A small protocol with every kind of vehicle data and section column"
  axis  distance in m
  time  time in s

parameter share "Share of the standard deviation"
  default  2/3
  range    0.01 to 10

parameter order "Order of the filter"
  default  2
  range    1 to 10

place side
  members  R, L
  alias    outer is L when direction is right, R when direction is left

vehicle category "Category"
  one of  passenger, freight

vehicle suspension "Secondary suspension"
  one of  true, false

vehicle Q0 "Static wheel force"
  in   kN
  key  static_wheel_load

section zone "Test zone"
  one of  zones

section direction "Direction"
  one of  right, left

section radius "Radius"
  in  m

channel Y "Guiding force"
  in      kN
  at      each side
  column  "Y_{side}"

filter LP "Low-pass filter"
  step  low-pass 2 Hz, order order

zone 1 "Curves"
  where             radius > 600 m
  minimum sections  1
  minimum length    1 m

zone 2 "Tight curves"
  where             radius <= 600 m
  minimum sections  1

sections
  zone    zone
  faulty  not used

quantity Y_max "Guiding force, maximum"
  of          Y
  filter      LP
  value       larger of |p0.15|, |p99.85|
  difference  magnitudes
  limit       std 9 kN * (1 + 0.01 * Q0/kN), doubled when vehicle.category is freight
  limit       mean share of limit of std

quantity Y_outer "Guiding force of the outer wheel"
  of          Y at side outer
  value       median
  difference  oriented
  limit       each 5 kN, doubled when not vehicle.suspension

verdict
  validated      when every limit holds
  minimum pairs  2
