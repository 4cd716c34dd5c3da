protocol limits-of-others "Limits that cannot be referred to"
  extends  en14363-2016-annex-t

estimate reads_a_limit "No limit is known in an estimate"
  is  mean + limit of std

quantity Y_max
  limit  p95 3 * std
  limit  median larger of mean, 1 kN
  limit  each 2 * std
  limit  rms limit of p80
  limit  p90 limit of std of ay_max
  limit  p85 limit of std of Y_mx
  limit  p70 reads_a_limit
  limit  p50 limit of stdd
