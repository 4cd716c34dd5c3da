# Several codes on one case: the spread of each, the largest difference between any two, and a bound on the mean of codes.

protocol codes "Codes against each other"
  extends  code-benchmark

quantity Y_qst
  limit  std 0.5 * force_tolerance for each wheelset
  limit  upper 95 % of mean force_tolerance for each wheelset

quantity Y_two "Largest difference between two codes"
  of          Y at wheelset 1 and each side
  filter      LP20
  value       rms
  compare     simulated with each other
  difference  signed
  limit       maximum force_tolerance
