protocol limits-of-others "Limits from those of other estimates and quantities"
  extends  en14363-2016-annex-t

estimate spread "Twice the standard deviation"
  is  2 * std

parameter level "A percentile"
  default  95 %

define half "Half of the limit"
  is  0.5 * limit of std

quantity Y_max
  limit  p95 3 * limit of std of Q_max
  limit  p90 0.9 * limit of p95
  limit  median half
  limit  spread larger of limit of std, 2 kN
  limit  (|mean| + std) limit of spread
  limit  range limit of (|mean| + std)
  limit  each limit of percentile level
  limit  std weighted by length limit of each for zones 1, 2

quantity Q_max
  limit  (share where value <= limit_of_values) at least 0.9
  limit  (share where value >= -20 kN) at least limit of (share where value <= limit_of_values)
  limit  rms 1.2 * limit of std of Y_max, times 1.1 when vehicle.category is locomotive

parameter limit_of_values "A number"
  default  20 kN

quantity ay_max
  limit  p95 3 * median * (1 + 1 / sqrt(n))
