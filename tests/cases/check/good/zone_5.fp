protocol zone-5 "Annex T with a zone of its own for the tightest curves"
  extends  en14363-2016-annex-t

zone 5 "Curves below 250 m"
  where             150 m <= radius < 250 m
  minimum sections  sections_per_zone
  minimum length    50 m
