# Sections found in long runs: constant speed, length by speed, the one with the most lateral movement.

protocol find "Sections found in long runs"
  extends  en14363-2016-annex-t-found-sections

sections
  step    0.5 m
  length  100 m when speed <= 100 km/h, otherwise 250 m
  prefer  std of ay at running gear I
  keep    at most 3 for each zone

remove
  find  deficiency
