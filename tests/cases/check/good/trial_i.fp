# Sections found in long runs: own zones by rule, constant speed, length by speed, one verdict for each country.

protocol runs "Sections found in long runs, by country"
  extends  en14363-2016-annex-t-found-sections

sections
  step    0.5 m
  prefer  std of ay at running gear I
  keep    at most 3 for each zone and country

remove
  quantity  every

quantity Y_max "Guiding force, maximum"
  of          Y at wheelsets 1, 3
  filter      LP20
  value       p99.85
  difference  magnitudes
  limit       std 10 kN for each country
  limit       mean 2/3 of limit of std for each country
