protocol mixed-limit "Relative above a threshold, absolute below"
  extends  "base.fp"

parameter relative "Share of the measured value"
  default  10 %

parameter absolute "Smallest limit"
  default  3 kN

quantity Y_max "Largest guiding force"
  of          Y at wheelsets 1, 3
  filter      LP20
  value       p99.85
  difference  signed
  limit       each larger of absolute, relative * |measured|
