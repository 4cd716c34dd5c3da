# A new test zone is a change of text: its block, and its word in the zone column.
protocol zone-5 "Annex T with a fifth test zone"
  extends  en14363-2016-annex-t

section zone
  one of  1, 2, 3, 4, 5

zone 5 "Extremely small radius curves"
  where             150 m <= radius < 250 m
  minimum sections  sections_per_zone
  minimum length    50 m
