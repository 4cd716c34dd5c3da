# A small protocol in canonical form: every kind of block, comments in every place.
# The numbers are made up.

# what it is
protocol wheel-forces-1.0 "Wheel forces: \"sum\" and single"
  extends  "parents/common rules.fp"
  edition  "2026"  # of this file
  # two remarks
  note     "First remark: long enough that it does not stand on one line, which has a hundred and ten columns"
           "at most."
  note     "Second remark # not a comment"
  # a remark below the last field

remove
  quantity  az_max
  # zone 5 stays
  zone      4

parameter cut_off "Cut-off of the low-pass filter"
  default  20 Hz
  range    10 Hz to 40 Hz

parameter order
  default  4

place side
  members  R, L
  alias    outer is L when direction is right, R when direction is left

vehicle category
vehicle running_gear "Running gear"

vehicle Q0 "Static vertical wheel force"  # per wheel
  in  kN

section radius
  in  m

channel Y "Guiding force"
  in      kN
  column  "Y_{wheelset}{side}"

signal SigmaY "Sum of guiding forces"
  is  Y at side R + Y at side L

filter LP20
  step  low-pass cut_off, order 4, zero-phase

define soft
  is  vehicle.category is freight or not vehicle.secondary_suspension

zone 1
  where           curve and radius > 600 m
  minimum length  100 m

check full_curve
  require  range of curvature <= 5 % * |mean of curvature|

sections
  minimum  12

quantity Y_max "Guiding force, maximum"
  symbol           "Y max"
  of               Y at wheelsets 1, 3
  value            larger of |p0.15|, |p99.85|
  difference       |simulated| - |measured|
  limit            std 9 kN  # as published
  limit            mean 2/3 of limit of std when vehicle.category is passenger
                   and vehicle.running_gear is bogies,
                   otherwise 4 kN
  minimum signals  2

verdict
  validated  when every limit holds

# the end
