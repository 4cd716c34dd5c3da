protocol asme-vv20 "ASME V&V 20 comparison error against validation uncertainty"
  extends  "base.fp"
  scope    "E = S - D, u_val = sqrt(u_num^2 + u_input^2 + u_D^2), |E| <= k u_val."

parameter k "Coverage factor"
  default  2
  range    1 to 3

vehicle u_num "Numerical standard uncertainty of a force"
  in       kN
  key      uncertainty.numerical
  default  0.2 kN

vehicle u_input "Input standard uncertainty, share of the value"
  in       -
  key      uncertainty.input
  default  5 %

vehicle u_D "Standard uncertainty of a measured force"
  in       kN
  key      uncertainty.measured
  default  0.5 kN

define u_val "Validation standard uncertainty"
  of  value_of_simulation
  is  sqrt(u_num^2 + (u_input * value_of_simulation)^2 + u_D^2)

quantity Y_E "Comparison error"
  of          Y at wheelsets 1, 3
  filter      LP20
  value       median
  difference  signed
  limit       each k * u_val(simulated)
  report      (share where |value| <= k * u_val(simulated)) for each zone
