# Magnitude and phase of time histories by section: values are not pooled, and each has its own limit.

protocol sprague-geers "Sprague & Geers metric of forces and accelerations, section by section"
  source  "Sprague & Geers, A spectral-element method for modelling cavitation in transient fluid-structure"
          "interaction, 2004; applied to rail vehicles by Fries et al., as described by Goetz & Polach"
  author  "Fishplate"
  scope   "Comparison of time histories of single sections. The publication gives no limits for rail"
          "vehicles. The limits are parameters to be set by the user."
  axis    distance in m
  time    time in s
  note    "The mean is not removed: an offset affects magnitude and phase. The measurement is the reference."

parameter magnitude_limit "Limit of the magnitude error"
  default  0.25
  range    0 to 10

parameter phase_limit "Limit of the phase error"
  default  0.25
  range    0 to 1

parameter comprehensive_limit "Limit of the comprehensive error"
  default  0.35
  range    0 to 10

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

quantity Y_magnitude "Guiding force, magnitude error"
  of      Y at wheelset 1 and side L
  filter  LP20
  metric  sprague-geers magnitude
  limit   each magnitude_limit

quantity Y_phase "Guiding force, phase error"
  of      Y at wheelset 1 and side L
  filter  LP20
  metric  sprague-geers phase
  limit   each phase_limit

quantity Y_comprehensive "Guiding force, comprehensive error"
  of      Y at wheelset 1 and side L
  filter  LP20
  metric  sprague-geers comprehensive
  limit   each comprehensive_limit

quantity Q_magnitude "Vertical wheel force, magnitude error"
  of      Q at wheelset 1 and side L
  filter  LP20
  metric  sprague-geers magnitude
  limit   each magnitude_limit

quantity Q_phase "Vertical wheel force, phase error"
  of      Q at wheelset 1 and side L
  filter  LP20
  metric  sprague-geers phase
  limit   each phase_limit

quantity Q_comprehensive "Vertical wheel force, comprehensive error"
  of      Q at wheelset 1 and side L
  filter  LP20
  metric  sprague-geers comprehensive
  limit   each comprehensive_limit

quantity ay_magnitude "Car body lateral acceleration, magnitude error"
  of      ay at running gear I
  filter  LP20
  metric  sprague-geers magnitude
  limit   each magnitude_limit

quantity ay_phase "Car body lateral acceleration, phase error"
  of      ay at running gear I
  filter  LP20
  metric  sprague-geers phase
  limit   each phase_limit

quantity ay_comprehensive "Car body lateral acceleration, comprehensive error"
  of      ay at running gear I
  filter  LP20
  metric  sprague-geers comprehensive
  limit   each comprehensive_limit

quantity az_magnitude "Car body vertical acceleration, magnitude error"
  of      az at running gear I
  filter  LP20
  metric  sprague-geers magnitude
  limit   each magnitude_limit

quantity az_phase "Car body vertical acceleration, phase error"
  of      az at running gear I
  filter  LP20
  metric  sprague-geers phase
  limit   each phase_limit

quantity az_comprehensive "Car body vertical acceleration, comprehensive error"
  of      az at running gear I
  filter  LP20
  metric  sprague-geers comprehensive
  limit   each comprehensive_limit

verdict
  validated  when every limit holds
