# Magnitude and phase of time histories by section: values are not pooled, and each has its own limit.

protocol sprague-geers "Sprague & Geers metric of forces and accelerations, section by section"
  uses    plausibility-signals
  source  "Sprague & Geers, A spectral-element method for modelling cavitation in transient fluid-structure"
          "interaction, 2004; applied to rail vehicles by Fries et al., as described by Goetz & Polach, Table"
          "2"
  author  "Fishplate"
  scope   "Comparison of time histories, quantity by quantity and section by section. Fries et al. applied"
          "the metric to accelerations of a passenger vehicle and suggested limits. Their numbers were not to"
          "hand: the limits here are parameters, to be replaced by theirs."
  axis    distance in m
  time    time in s
  note    "The mean is not removed: an offset affects magnitude and phase. The measurement is the reference."

parameter magnitude_limit "Limit of the magnitude error"
  default      0.25
  range        0 to 10
  unconfirmed  "A choice of this text; the limits suggested by Fries et al. were not to hand."

parameter phase_limit "Limit of the phase error"
  default      0.25
  range        0 to 1
  unconfirmed  "A choice of this text; the limits suggested by Fries et al. were not to hand."

parameter comprehensive_limit "Limit of the comprehensive error"
  default      0.35
  range        0 to 10
  unconfirmed  "A choice of this text; the limits suggested by Fries et al. were not to hand."

place wheelset
  members  1, 2, 3, 4

place side
  members  R, L

place running_gear
  members  I, II

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

channel az "Car body vertical acceleration"
  in      m/s^2
  at      each running_gear
  column  "az_{running_gear}"

filter LP20 "Low-pass filter 20 Hz"
  step  low-pass 20 Hz, order 4, zero-phase, as-applied

quantity {channel}_{part} "{title}, {part} error"
  for each  channel, title, position in (Y, Guiding force, wheelset 1 and side L),
            (Q, Vertical wheel force, wheelset 1 and side L),
            (ay, Car body lateral acceleration, running gear I),
            (az, Car body vertical acceleration, running gear I)
  for each  part in magnitude, phase, comprehensive
  of        {channel} at {position}
  filter    LP20
  metric    sprague-geers {part}
  limit     each {part}_limit

verdict
  validated  when every limit holds
