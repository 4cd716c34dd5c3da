protocol small "Small"
  axis  distance in m
  time  time in s

vehicle category "Category"
  one of  light, heavy

section country "Country"
  one of  A, B

channel a "A"
  in  kN

channel b "B"
  in  kN

channel c "C"
  in  kN

filter LP "Low-pass"
  step  low-pass 2 Hz, order 2, zero-phase

define most "Largest mean"
  is  0.9 kN when category is heavy, otherwise 0.7 kN

check long "Length"
  require  length >= 50 m

quantity qa "A"
  of          a
  filter      LP
  value       mean
  difference  signed
  limit       std 1 kN
  limit       mean 2/3 of limit of std

quantity qb "B"
  of          b
  value       p95
  difference  signed
  limit       mean most

quantity qc "C"
  of          c
  filter      LP
  value       maximum
  difference  |simulated| - |measured|
  limit       each 2 kN

verdict
  validated  when every limit holds
