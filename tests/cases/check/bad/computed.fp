protocol computed "Section data that cannot be computed"
  extends  en14363-2016-annex-t

section zone
  is  1 when radius > 600 m, otherwise 2

section conicity "Equivalent conicity"
  in  -

section typed "Computed, and in a column"
  one of  low, high
  column  "class"
  is      low when conicity < 0.1, otherwise high

section found_too "Computed, and found"
  in     -
  found  0.1
  is     2 * conicity

section given "Computed, with a value for empty cells"
  in       -
  default  0.1
  is       2 * conicity

section absent "Computed, and perhaps absent"
  in        -
  optional  not assessed
  is        2 * conicity

section other_word "No word of the list"
  one of  low, high
  is      low when conicity < 0.1, medium when conicity < 0.25, otherwise high

section number "A word for a number"
  in  -
  is  low when conicity < 0.1, otherwise high

section length_of "Another dimension"
  in  m
  is  2 * conicity

section of_signal "A signal of the section"
  in  m/s^2
  is  mean of ay at running_gear I

section of_values "What is not known of a section"
  in  kN
  is  simulated

section edge "Without the number 0.1"
  one of  low, high
  is      low when conicity < 0.1, high when conicity > 0.1
