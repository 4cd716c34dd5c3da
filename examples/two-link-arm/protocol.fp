# A first protocol for the records of this campaign. The limits are a tenth of what was measured: placeholders, to be set.

protocol two-link-arm-protocol "Protocol of two-link-arm"
  author  "To be stated"
  scope   "To be stated: for which machines, tests and uses of the model."
  axis    time in s

parameter torque_1_limit "Limit of torque_1"
  default      0.033 N*m
  unconfirmed  "To be set: a tenth of the measured rms value."

parameter torque_2_limit "Limit of torque_2"
  default      0.054 N*m
  unconfirmed  "To be set: a tenth of the measured rms value."

channel torque_1 "torque_1"
  in      N m
  column  "torque_1"

channel torque_2 "torque_2"
  in      N m
  column  "torque_2"

filter LP "Low-pass filter above the content of the records"
  step  low-pass 45 Hz, order 2, zero-phase, as-applied

quantity torque_1_rms "torque_1, rms value"
  of          torque_1
  filter      LP
  value       rms
  difference  simulated - measured
  limit       std torque_1_limit
  limit       mean torque_1_limit

quantity torque_1_high "torque_1, 97.5 % value"
  of          torque_1
  filter      LP
  value       p97.5
  difference  simulated - measured
  limit       std 2 * torque_1_limit
  limit       mean 2 * torque_1_limit

quantity torque_2_rms "torque_2, rms value"
  of          torque_2
  filter      LP
  value       rms
  difference  simulated - measured
  limit       std torque_2_limit
  limit       mean torque_2_limit

quantity torque_2_high "torque_2, 97.5 % value"
  of          torque_2
  filter      LP
  value       p97.5
  difference  simulated - measured
  limit       std 2 * torque_2_limit
  limit       mean 2 * torque_2_limit

verdict
  validated  when every limit holds
