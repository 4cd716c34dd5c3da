# Motion sickness by the vertical acceleration: one dose for each record.

protocol iso2631-msdv "Motion sickness dose value in the manner of ISO 2631-1"
  uses     plausibility-signals
  edition  "ISO 2631-1:1997, clause 9 and annex D"
  source   "ISO 2631-1:1997: the weighting Wf and the dose from memory; the standard was not to hand"
  author   "Fishplate"
  scope    "The dose of the measurement, of the simulation, and their difference, over each record as a"
           "whole."
  axis     time in s
  time     time in s
  note     "The standard gives no limit. A third of the dose in m/s^1.5 is about the percentage of unadapted"
           "adults who may vomit; from memory. The limits here are the user's."

parameter largest_dose "Largest dose"
  default      30 m/s^1.5
  range        0.1 m/s^1.5 to 200 m/s^1.5
  unconfirmed  "A choice of this text."

parameter largest_difference "Largest difference of the doses, share of the measured one"
  default      10 %
  range        0.1 % to 100 %
  unconfirmed  "A choice of this text."

place running_gear
  members  I, II

channel az "Vertical acceleration at floor level"
  in      m/s^2
  at      each running_gear
  column  "az_{running_gear}"

signal dose "Integral of the squared weighted acceleration"
  is  integral((az through Wf) * (az through Wf))
  at  each running_gear

filter Wf "Weighting of motion sickness"
  step    transfer function poles 0.08 Hz quality 0.70711 zeros 0 Hz
  step    transfer function poles 0.63 Hz quality 0.70711
  step    transfer function poles 0.25 Hz quality 0.86
  step    transfer function poles 0.1 Hz quality 0.8 zeros 0.0625 Hz quality 0.8, gain (0.0625^2/0.1^2)
  source  "ISO 2631-1:1997, Table A.1; from memory"

check duration "Long enough for waves of 0.1 Hz"
  require    length >= 60 s
  otherwise  note

plausibility gravity "Acceleration without the acceleration of gravity"
  of       az
  require  |median| <= 5 m/s^2
  cause    "an accelerometer whose offset was not removed"

sections
  use  whole records

quantity dose_{side} "Motion sickness dose value, {side}"
  for each  side in measured, simulated
  of        dose
  from      {side}
  value     sqrt(last - first)
  limit     each largest_dose
  in        m/s^1.5

quantity dose_difference "Motion sickness dose value, simulated less measured over measured"
  of          dose
  value       sqrt(last - first)
  difference  (simulated - measured) / measured
  limit       each largest_difference

verdict
  validated  when every limit holds
