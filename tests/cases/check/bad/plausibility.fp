protocol plausibility "Faults of plausibility rules"
  axis  distance in m
  time  time in s

place side
  members  R, L

channel Q
  in  kN
  at  each side

vehicle Q0
  in  kN

plausibility two_tests
  of        Q
  require   held <= 5 %
  distinct  channels

plausibility nothing_said
  of  Q

plausibility among_what
  of        Q
  distinct  channels, runs

plausibility of_nothing
  require  held <= 5 %

plausibility wrong_unit
  of       Q
  require  median near 3 m within 5 %

plausibility wrong_tolerance
  of       Q
  require  median near Q0 within 3 s

plausibility factor_with_unit
  of       Q
  require  median near Q0 within a factor of 2 kN

plausibility factor_below_one
  of       Q
  require  median near Q0 within a factor of 0.5

plausibility no_condition
  of       Q
  require  median

plausibility no_such_treatment
  of         Q
  require    correlaton >= 0
  otherwise  refuse

plausibility exchanged_in_words
  of         Q
  exchanged  mostly

plausibility exchanged_above_one
  of         Q
  exchanged  from 0.5, by 3

plausibility two_ways
  of         Q
  require    median >= 0 kN
  exchanged  from 0.5, by 0.3

plausibility window_before_metric
  of       Q
  filter   sliding mean 2 m every 0.5 m
  require  correlation >= 0

quantity Q_mean
  of          Q
  value       mean
  difference  signed
  limit       std 5 kN
