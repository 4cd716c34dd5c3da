protocol motion-sickness-dose "ISO 2631-1 style motion sickness dose value"
  axis  time in s
  time  time in s

place running_gear
  members  I, II

channel az "Vertical acceleration"
  in  m/s^2
  at  each running_gear

signal aw "Weighted acceleration"
  is  az through Wf
  at  each running_gear

signal dose "Integral of the squared weighted acceleration"
  is  integral(aw * aw)
  at  each running_gear

filter Wf
  step  transfer function poles 0.08 Hz quality 0.70711 zeros 0 Hz
  step  transfer function poles 0.63 Hz quality 0.70711
  step  transfer function poles 0.25 Hz quality 0.86
  step  transfer function poles 0.1 Hz quality 0.8 zeros 0.0625 Hz quality 0.8, gain (0.0625^2/0.1^2)

quantity MSDV "Motion sickness dose value"
  of     dose
  from   measured
  value  sqrt(last - first)
  limit  each 30 m/s^1.5
  in     m/s^1.5

quantity MSDV_rms "Motion sickness dose value, rms times the root of the duration"
  of      az
  filter  Wf
  from    measured
  value   rms * length^0.5
  limit   each 30 m/s^1.5
  in      m/s^1.5

quantity MSDV_difference
  of          dose
  value       sqrt(last - first)
  difference  (simulated - measured) / measured
  limit       each 10 %
