protocol small-new "Small, new"
  extends  "old.fp"

filter LP "Low-pass, as it is used"
  step  low-pass 1 Hz, order 2, zero-phase

define most "Largest mean"
  is  0.8 kN

define scatter_limit "Largest standard deviation"
  is  0.6 kN

check long "Length"
  require  length >= 70 m

quantity qa
  limit  std scatter_limit

quantity qb
  value  p90

quantity qc
  limit  each 1.2 kN

verdict
  validated  when at least 2 quantities hold
