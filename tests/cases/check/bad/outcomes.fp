protocol outcomes "Outcomes that cannot be in order"
  axis  distance in m

channel Y "Guiding force"
  in      kN
  column  "Y_1R"

quantity no_rule "Nothing behind it can apply"
  of          Y
  value       rms
  difference  signed
  outcome     good: holds
  outcome     fair: holds when std <= 2 kN
  outcome     poor: fails

quantity last_rule "The last has a rule, one word stands twice"
  of          Y
  value       rms
  difference  signed
  outcome     good: holds when std <= 1 kN
  outcome     good: fails when std <= 2 kN

quantity order "One that holds behind one that fails; no condition on values"
  of          Y
  value       rms
  difference  signed
  outcome     poor: fails when std > 2 kN
  outcome     good: holds when std <= 1 kN
  outcome     not good: fails

quantity always "All hold"
  of          Y
  value       rms
  difference  signed
  outcome     good: holds when std <= 1 m
  outcome     fair: holds

verdict graded "Either outcomes or a rule"
  of       no_rule, order
  holds    when every limit holds
  outcome  accepted: holds when at least 9 quantities hold
  outcome  accepted with restriction: fails

verdict
  outcome  validated: holds when graded holds
  outcome  valid in part: fails
