protocol k-of-n "k of n exceedances allowed, by a table of sampling"
  extends  "base.fp"

parameter tolerance "What a section may be off by"
  default  2 kN

quantity worst "Quasi-static guiding force, wheel 1R"
  of          Y at wheelset 1 and side R
  filter      LP20
  value       median
  difference  signed
  report      exceedances
  report      allowed
  report      n
  outcome     accepted: holds when exceedances <= allowed
  outcome     rejected: fails

quantity all "Quasi-static guiding force, every wheel: 2 may exceed"
  of          Y at wheelsets 1, 3
  filter      LP20
  value       median
  difference  signed
  limit       (count where |value| > tolerance) at most 2

estimate exceedances "Number of sections with exceedances"
  is  count where |value| > tolerance

estimate allowed "Acceptance number: 0 up to 7, 1 from 8, 2 from 13 sections"
  is  2 when n >= 13, 1 when n >= 8, otherwise 0
