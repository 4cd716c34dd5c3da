# Model validation for cross wind. The paper names what is compared; limits of the comparison are this protocol's own.

protocol en14067-6-wheel-unloading "Vertical wheel unloading, simulated and compared with the measurement, EN 14067-6 kind"
  uses     plausibility-signals
  edition  "Similar to EN 14067-6:2010"
  source   "Goetz & Polach, section 3.3: the model is validated by vertical wheelset and wheel forces and by"
           "the flexibility coefficient"
  author   "Fishplate"
  scope    "Models used for cross wind. The unloading of a running gear is the mean over its wheels of one"
           "side. In curves the lateral acceleration unloads one side as the wind does: there the simulated"
           "unloading is compared with the measured one. The largest simulated unloading, with or without"
           "wind, has a limit."
  axis     distance in m
  time     time in s

parameter unloading_limit "Limit of the simulated wheel unloading of a running gear"
  default      0.9
  range        0.1 to 1
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14067-6:2010"

parameter lowpass_frequency "Cut-off of the low-pass filter of the wheel forces"
  default      2 Hz
  range        0.5 Hz to 20 Hz
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14067-6:2010"

parameter unloading_difference "Limit of the difference of simulated and measured unloading"
  default      0.05
  range        0.001 to 1
  unconfirmed  "A choice of this text."
  source       "This protocol's own: the standard, as the paper says of such standards, gives no matching"
               "error"

parameter force_difference "Limit of the difference of simulated and measured quasi-static wheelset force, over the static one"
  default      0.05
  range        0.001 to 1
  unconfirmed  "A choice of this text."
  source       "This protocol's own"

place wheelset
  members  1, 2, 3, 4

place side
  members  R, L

vehicle Q0 "Static vertical wheel force"
  in     kN
  key    static_wheel_load
  range  10 kN to 200 kN

section direction "Direction"
  one of  right, left, straight

channel Q "Vertical wheel force"
  in      kN
  at      each wheelset and side
  column  "Q_{wheelset}{side}"

signal unloading_{gear} "Wheel unloading of running gear {gear}"
  for each  gear, front, rear in (I, 1, 2), (II, 3, 4)
  is        1 - (Q at wheelset {front} + Q at wheelset {rear}) / (2 * Q0)
  at        each side
  in        -
  named     "unloading_{gear}{side}"

signal axle_force "Vertical force of a wheelset over the static one"
  is     (Q at side R + Q at side L) / (2 * Q0)
  at     each wheelset
  in     -
  named  "axle_force_{wheelset}"

filter LP2 "Low-pass filter of the wheel forces"
  step    low-pass lowpass_frequency, order 4, zero-phase
  source  "EN 14067-6:2010; order and phase are this protocol's own"

sections
  use     sections
  faulty  not used

quantity unloading_{gear}_largest "Simulated wheel unloading of running gear {gear}, largest value"
  for each  gear in I, II
  symbol    "(ΔQ/Q)_{gear}"
  of        unloading_{gear}
  filter    LP2
  from      simulated
  value     maximum
  limit     each unloading_limit

quantity unloading_{gear}_compared "Wheel unloading of running gear {gear} in curves, quasi-static"
  for each    gear in I, II
  symbol      "(ΔQ/Q)_{gear},qst"
  of          unloading_{gear}
  filter      LP2
  value       median
  difference  signed
  limit       each unloading_difference
  where       direction is not straight

quantity wheelset_force_compared "Vertical force of a wheelset, quasi-static"
  symbol      "ΣQ_qst"
  of          axle_force
  filter      LP2
  value       median
  difference  signed
  limit       each force_difference

verdict wheel_unloading "Model of the vertical wheel unloading"
  of     unloading_I_compared, unloading_II_compared, wheelset_force_compared
  holds  when every limit holds
  words  validated, not validated

verdict safety "Wheel unloading of the simulated runs"
  of     unloading_I_largest, unloading_II_largest
  holds  when every limit holds
  words  below the limit, above the limit
