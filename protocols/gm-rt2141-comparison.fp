# Derailment resistance and roll-over are assessed in Great Britain by calculation, test or both. What is compared is stated here;
# the judgement is a person's.

protocol gm-rt2141-comparison "Comparison of simulation and test for derailment resistance, judged by a person, GM/RT2141 kind"
  uses     plausibility-signals
  edition  "Similar to GM/RT2141"
  source   "Goetz & Polach, section 1: the document asks for comparisons and gives no quantitative limits of"
           "validation"
  author   "Fishplate"
  scope    "Models used for derailment resistance: Y/Q of the guiding wheels, unloading of single wheels, and"
           "roll of the body as far as accelerometers show it. Simulated and measured values stand side by"
           "side for each section; the reference lines are for orientation and decide nothing. The"
           "responsible engineer judges."
  axis     distance in m
  time     time in s
  note     "The text of GM/RT2141 was not to hand."

parameter YQ_reference "Reference line of Y/Q"
  default      1.2
  range        0.1 to 2
  unconfirmed  "From memory; the standard was not to hand."
  source       "Limit of flange climbing for a flange angle of 70 degrees (Nadal)"

parameter unloading_reference "Reference line of the wheel unloading"
  default      0.6
  range        0.1 to 1
  unconfirmed  "From memory; the standard was not to hand."
  source       "GM/RT2141"

parameter {value}_reference "Reference line of the difference of {title}"
  for each  value, title, default in (YQ_difference, "Y/Q", 0.2),
            (unloading_difference, "the wheel unloading", 0.1),
            (ay_difference, "the lateral acceleration", 0.2 m/s^2)
  default   {default}
  source    "This protocol's own, for orientation"

place wheelset
  members  1, 2, 3, 4

place side
  members  R, L

place running_gear
  members  I, II

vehicle Q0 "Static vertical wheel force"
  in     kN
  key    static_wheel_load
  range  10 kN to 200 kN

channel Y "Guiding force"
  in      kN
  at      each wheelset and side
  column  "Y_{wheelset}{side}"

channel Q "Vertical wheel force"
  in      kN
  at      each wheelset and side
  column  "Q_{wheelset}{side}"

channel ay "Car body lateral acceleration"
  in      m/s^2
  at      each running_gear
  column  "ay_{running_gear}"

signal YQ "Ratio Y/Q"
  is     Y / Q
  at     each wheelset and side
  in     -
  named  "YQ_{wheelset}{side}"

signal unloading "Wheel unloading"
  is     1 - Q / Q0
  at     each wheelset and side
  in     -
  named  "unloading_{wheelset}{side}"

filter LP20 "Low-pass filter 20 Hz"
  step  low-pass 20 Hz, order 4, zero-phase

sections
  use     sections
  faulty  not used

quantity YQ_difference "Ratio Y/Q, largest magnitude over 2 m"
  symbol      "(Y/Q)_max"
  of          YQ
  filter      LP20, then sliding mean 2 m every 0.5 m
  value       larger of |p0.15|, |p99.85|
  difference  signed
  limit       each YQ_difference_reference

quantity unloading_difference "Wheel unloading, largest value"
  symbol      "ΔQ/Q_0"
  of          unloading
  filter      LP20
  value       p99.85
  difference  signed
  limit       each unloading_difference_reference

quantity ay_difference "Car body lateral acceleration, quasi-static"
  symbol      "ÿ*_qst"
  of          ay
  filter      LP20
  value       median
  difference  signed
  limit       each ay_difference_reference

quantity YQ_{record} "Ratio Y/Q, {record}"
  for each  record in measured, simulated
  symbol    "(Y/Q)_{record}"
  of        YQ
  filter    LP20, then sliding mean 2 m every 0.5 m
  from      {record}
  value     larger of |p0.15|, |p99.85|
  limit     each YQ_reference

quantity unloading_{record} "Wheel unloading, {record}"
  for each  record in measured, simulated
  symbol    "ΔQ/Q_0,{record}"
  of        unloading
  filter    LP20
  from      {record}
  value     p99.85
  limit     each unloading_reference

verdict model "Model is fit for the assessment of derailment resistance"
  judged by  "the responsible engineer"
  words      fit, not fit

verdict differences_within "All differences of simulation and measurement within the reference lines"
  of     compared
  holds  when every limit holds
  words  within, beyond

verdict {record}_within "All values of the {record} vehicle within the reference lines"
  for each  record in measured, simulated
  of        {record}
  holds     when every limit holds
  words     within, beyond
