protocol sample-conditions "Conditions on samples, and functions, that cannot be"
  axis  distance in m

channel Y "Guiding force"
  in      kN
  column  "Y_1R"

channel Q "Vertical wheel force"
  in      kN
  column  "Q_1R"

section direction "Direction of the curve"
  one of  straight, right, left

signal high "Some samples are missing"
  is  Y when Q > 60 kN

define scaled "A function"
  of  x, scale
  is  x / scale

define loop "A function of itself"
  of  x
  is  loop(x)

define twice "An argument named twice"
  of  x, x
  is  x

filter LP "A filter"
  step  low-pass 20 Hz

quantity filtered "Samples are missing before a filter"
  of          Y
  value       rms of ((Y when Q > 60 kN) through magnitude)
  difference  signed
  limit       std 1 kN

quantity section "A condition on the section alone"
  of          Y
  value       share where direction is right
  difference  signed
  limit       std 1

quantity counted "The number of samples"
  of          Y
  value       count where Y > 2 kN
  difference  signed
  limit       std 1

quantity units "A condition between two dimensions"
  of          Y
  value       share where Y > 2 m
  difference  signed
  limit       std 1

quantity time "There is no time"
  of          Y
  value       longest run in time where Y > 2 kN
  difference  signed
  limit       std 1 s

quantity few "Too few arguments"
  of          Y
  value       rms of scaled(Y)
  difference  signed
  limit       std 1 kN

quantity bare "No arguments"
  of          Y
  value       rms of scaled
  difference  signed
  limit       std 1 kN

quantity looped "A function of itself"
  of          Y
  value       rms of loop(Y)
  difference  signed
  limit       std 1 kN

quantity of_values "A run of values, and a weighted number"
  of          Y
  value       rms
  difference  signed
  limit       (longest run where value > 2 kN) 10 m
  limit       (count weighted by length where value > 2 kN) at most 3
  limit       std 1 kN

quantity nearness "Nearness is of numbers"
  of     Q
  from   measured
  value  share where Q near 50 kN within 10 % and Q > 1 kN
  in     -
