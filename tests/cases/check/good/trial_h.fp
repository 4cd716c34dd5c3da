protocol next_edition "Counts and means of another edition"
  extends  en14363-2016-annex-t

zone 5 "Extremely small radius curves"
  where             150 m <= radius < 250 m
  minimum sections  0
  minimum length    50 m

remove
  limit  Y_max

quantity Y_max
  limit  std 9 kN for zones 1, 2, 3, 4
  limit  std 11 kN for zones 5
  limit  mean 2/3 of limit of std for zones 1, 2, 3, 4
  limit  mean 2/3 of limit of std for zones 5
  limit  (total of length) at least 600 m for zone 1
  limit  (mean of radius) at least 400 m for zone 3
  limit  (share of sections where cant_deficiency >= 60 mm) at least 20 %
  limit  (n) at least 9
