protocol limits-of-other-sections "Limits of other sections, and below zero"
  extends  en14363-2016-annex-t

quantity Y_max
  limit  peak limit of p95 of Q_max
  limit  p60 limit of p75 of Q_qst for zones 1, 2

quantity Q_max
  limit  p95 2 * limit of peak of Y_max

quantity Q_qst
  limit  p75 3 kN for zones 3, 4
  limit  p65 limit of std of Y_max - 9 kN
