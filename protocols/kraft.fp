# Misfit of signals by section, judged by the misfit of repeated measurements.

protocol kraft "Misfit of the signals over a set of sections, judged by repeated runs"
  uses    plausibility-signals
  source  "Kraft et al. 2013, as described by Goetz & Polach, Table 2 and section 2"
  author  "Fishplate"
  scope   "Comparison of simulation models by the cumulative frequency of their misfits over sections. The"
          "original publication was not to hand: the form of the metric follows the description, and the"
          "parts of sections are parameters."
  axis    distance in m
  time    time in s
  note    "The misfit of a signal in a section is the sum of the squared differences of simulation and"
          "measurement over the smaller of the two sums of squares. The mean is not removed. Its square root"
          "is the misfit that other descriptions use."
  note    "The quality index is the 80 % value of the misfits of sections that were measured twice, between"
          "repeat and original (column `repeat of` of the table of sections). So much do two runs of the"
          "vehicle itself differ. A model is as good as a repetition if 80 % of its misfits are not above it."
  note    "With several simulations in the campaign each is judged by itself, and each has a curve in the"
          "figure."

parameter quality_share "Part of the misfits that must not exceed the quality index"
  default      0.8
  range        0.01 to 1
  unconfirmed  "The part, and the 80 % value as the quality index, are choices of this text; the publication"
               "was not to hand."

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

signal YQ "Ratio Y/Q"
  is     Y / Q
  at     each wheelset and side
  in     -
  named  "YQ_{wheelset}{side}"
  note   "Calculated sample by sample, then filtered."

signal SigmaY "Sum of guiding forces"
  is     Y at side R + Y at side L
  at     each wheelset
  in     kN
  named  "SigmaY_{wheelset}"

filter LP20 "Low-pass filter 20 Hz"
  step  low-pass 20 Hz, order 4, zero-phase, as-applied

quantity {signal}_repeated "{title}, misfit of repeated measurements"
  for each  signal, title, positions in (Y, Guiding force, "wheelsets 1, 3"),
            (Q, Vertical wheel force, "wheelsets 1, 3"), (YQ, Ratio Y/Q, "wheelsets 1, 3"),
            (SigmaY, Sum of guiding forces, "wheelsets 1, 3"),
            (ay, Car body lateral acceleration, "running gears I, II"),
            (az, Car body vertical acceleration, "running gears I, II")
  of        {signal} at {positions}
  filter    LP20
  compare   repeats with originals
  metric    misfit

quantity {signal}_misfit "{title}, misfit of the model"
  for each  signal, title, positions in (Y, Guiding force, "wheelsets 1, 3"),
            (Q, Vertical wheel force, "wheelsets 1, 3"), (YQ, Ratio Y/Q, "wheelsets 1, 3"),
            (SigmaY, Sum of guiding forces, "wheelsets 1, 3"),
            (ay, Car body lateral acceleration, "running gears I, II"),
            (az, Car body vertical acceleration, "running gears I, II")
  of        {signal} at {positions}
  filter    LP20
  metric    misfit
  limit     (share where value <= p80 of {signal}_repeated) at least quality_share for each record

verdict
  validated  when every limit holds
