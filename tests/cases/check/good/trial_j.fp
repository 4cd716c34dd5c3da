protocol states "Two states of load and repeated runs, pooled"
  extends  en14363-2016-annex-t

remove
  quantity  every

section state "State of load"
  one of   tare, laden
  default  tare

section Q0_state "Static wheel load of the state"
  in       kN
  default  54.5 kN

quantity Q_max "Vertical wheel force, maximum"
  of          Q at wheelsets 1, 3
  filter      LP20
  value       p99.85
  difference  magnitudes
  limit       std 6 kN * (1 + 0.01 * (mean of Q0_state)/kN) for each state
  limit       mean 2/3 of limit of std for each state

quantity Q_max_n "Vertical wheel force, maximum, by the limit of its state"
  of          Q at wheelsets 1, 3
  filter      LP20
  value       p99.85
  difference  (|simulated| - |measured|) / (6 kN * (1 + 0.01 * Q0_state/kN))
  limit       std 1
  limit       mean 2/3

quantity repeatability "Scatter of the measurement within one site"
  of      Y at wheelsets 1, 3
  filter  LP20
  from    measured
  value   median
  limit   std 50 kN for each site and wheelset
