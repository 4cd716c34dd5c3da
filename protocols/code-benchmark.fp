# Comparison of codes in the manner of the ERRI B176 benchmark and the Manchester Benchmarks: several programs
# simulate one case, and their results are compared with each other. The numbers that these benchmarks published
# were not to hand: nothing here is taken from them. Both tolerances are this protocol's own choice.

protocol code-benchmark "Comparison of simulation codes on one case"
  uses    plausibility-signals
  source  "Kind of comparison: ERRI B176; Iwnicki, Manchester Benchmarks for Rail Vehicle Simulation, Vehicle"
          "System Dynamics 30 (1998), 295-313. The published numbers were not to hand."
  author  "Fishplate"
  scope   "Results of several simulation programs, or of one program with several settings, for the same"
          "vehicle on the same track. The campaign names a folder of simulated records for each code."
  axis    distance in m
  time    time in s
  note    "Spread: a code less the mean of all codes. It does not tell which code is right, and one code that"
          "differs moves the mean. See also code-benchmark-reference."

parameter force_tolerance "Largest spread of a force"
  default      1 kN
  range        0.001 kN to 50 kN
  unconfirmed  "A choice of this text."
  source       "Own choice; to be agreed by those who compare"

parameter acceleration_tolerance "Largest spread of an acceleration"
  default      0.05 m/s^2
  range        0.0001 m/s^2 to 10 m/s^2
  unconfirmed  "A choice of this text."
  source       "Own choice; to be agreed by those who compare"

parameter evaluated_wheelsets "Wheelsets whose forces are compared"
  default  1
  at       wheelset

parameter evaluated_gears "Running gears above which accelerations are compared"
  default  I
  at       running_gear

place wheelset
  members  1, 2, 3, 4

place side
  members  R, L

place running_gear
  members  I, II

section radius "Curve radius"
  in  m

section direction "Direction"
  one of  right, left, straight

section cant_deficiency "Cant deficiency"
  in  mm

section speed "Speed"
  in  km/h

channel Y "Guiding force"
  in      kN
  at      each wheelset and side
  column  "Y_{wheelset}{side}"
  note    "Positive to the right of the running direction."

channel Q "Vertical wheel force"
  in      kN
  at      each wheelset and side
  column  "Q_{wheelset}{side}"

channel ay "Car body lateral acceleration"
  in      m/s^2
  at      each running_gear
  column  "ay_{running_gear}"

channel az "Car body vertical acceleration"
  in      m/s^2
  at      each running_gear
  column  "az_{running_gear}"

filter LP20 "Low-pass filter 20 Hz"
  step  low-pass 20 Hz, order 4, zero-phase, as-applied

plausibility copies
  distinct  channels, sections, records
  note      "Codes that solve one case well agree in many written digits: a copy is the same in all of its"
            "channels."

quantity {force}_qst "{title}, quasi-static value: spread"
  for each    force, title in (Y, Guiding force), (Q, Vertical wheel force)
  symbol      "{force}_qst"
  of          {force} at wheelsets evaluated_wheelsets and each side
  filter      LP20
  value       median
  compare     simulated with mean of simulated
  difference  signed
  limit       each force_tolerance for each record
  where       direction is not straight

quantity {force}_max "{title}, maximum: spread"
  for each    force, title in (Y, Guiding force), (Q, Vertical wheel force)
  symbol      "{force}_max"
  of          {force} at wheelsets evaluated_wheelsets and each side
  filter      LP20
  value       larger of |p0.15|, |p99.85|
  compare     simulated with mean of simulated
  difference  signed
  limit       each force_tolerance for each record

quantity {acceleration}_{what} "{title}, {what}: spread"
  for each    acceleration, title in (ay, Car body lateral acceleration), (az, Car body vertical acceleration)
  for each    what, value in (rms, rms), (max, (larger of |p0.15|, |p99.85|))
  symbol      "{acceleration}_{what}"
  of          {acceleration} at running gears evaluated_gears
  filter      LP20
  value       {value}
  compare     simulated with mean of simulated
  difference  signed
  limit       each acceleration_tolerance for each record

verdict
  validated  when every limit holds
  words      "agreement within the tolerances", "no agreement within the tolerances"
