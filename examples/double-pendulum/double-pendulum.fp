# Torques of a driven double pendulum over time: no track, no zones.

protocol double-pendulum "Torques of a double pendulum from inverse dynamics"
  author  "Fishplate"
  scope   "Rigid-body models of driven pendulums and arms. The limits are chosen for this example and are not"
          "from a standard."
  axis    time in s

place joint
  members  1, 2

channel tau "Torque of a joint"
  in      N m
  at      each joint
  column  "tau_{joint}"

filter LP6 "Low-pass filter 6 Hz"
  step  low-pass 6 Hz, order 2, zero-phase, as-applied

quantity shoulder_rms "Torque at the shoulder, rms value"
  of          tau at joint 1
  filter      LP6
  value       rms
  difference  simulated - measured
  limit       std 0.03 N*m
  limit       mean 0.02 N*m

quantity shoulder_high "Torque at the shoulder, 97.5 % value"
  of          tau at joint 1
  filter      LP6
  value       p97.5
  difference  simulated - measured
  limit       std 0.06 N*m
  limit       mean 0.04 N*m

quantity elbow_rms "Torque at the elbow, rms value"
  of          tau at joint 2
  filter      LP6
  value       rms
  difference  simulated - measured
  limit       std 0.03 N*m
  limit       mean 0.02 N*m

quantity elbow_high "Torque at the elbow, 97.5 % value"
  of          tau at joint 2
  filter      LP6
  value       p97.5
  difference  simulated - measured
  limit       std 0.06 N*m
  limit       mean 0.04 N*m

verdict
  validated  when every limit holds
