# Matching of the distributions of two signals, section by section: variances by Fisher's test, means by their difference.

protocol bogojevic-lucanin "Matching probability of cumulative distributions, signal by signal and section by section"
  uses    plausibility-signals
  source  "Bogojevic & Lucanin 2014, as described by Goetz & Polach, Table 2 and section 2"
  author  "Fishplate"
  scope   "Comparison of the distributions of measured and simulated signals in single sections. The original"
          "publication was not to hand: the form of the metric follows the description, and the number of"
          "points and the limit are parameters."
  axis    distance in m
  time    time in s
  note    "Both signals are replaced by so many quantiles, at (i - 0.5)/n of their cumulative distributions."
          "The metric is the probability of Fisher's test that their variances are equal, times 1 less the"
          "difference of their means over the larger of the two (the supremum). 1 is a perfect match."
  note    "The number of points decides: the test takes each point as an independent value, so that the same"
          "difference of variances has a smaller probability the more points there are. The metric at 20, 50"
          "and 100 points is reported beside that at the number chosen."
  note    "The metric knows nothing of time: a shifted signal matches as well as one that is not."

parameter cdf_points "Number of points of each cumulative distribution"
  default      50
  range        3 to 1000
  unconfirmed  "The number of points is a choice of this text; that of the publication was not to hand."

parameter matching_limit "Smallest matching probability that counts as a match"
  default      0.5
  range        0 to 1
  unconfirmed  "The limit is a choice of this text; the publication was not to hand."

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

quantity {signal}_match "{title}, matching probability"
  for each  signal, title, positions in (Y, Guiding force, "wheelsets 1, 3"),
            (Q, Vertical wheel force, "wheelsets 1, 3"), (YQ, Ratio Y/Q, "wheelsets 1, 3"),
            (SigmaY, Sum of guiding forces, "wheelsets 1, 3"),
            (ay, Car body lateral acceleration, "running gears I, II"),
            (az, Car body vertical acceleration, "running gears I, II")
  of        {signal} at {positions}
  filter    LP20
  metric    matching probability, points cdf_points
  limit     each at least matching_limit

quantity {signal}_fisher "{title}, probability of Fisher's test"
  for each  signal, title, positions in (Y, Guiding force, "wheelsets 1, 3"),
            (Q, Vertical wheel force, "wheelsets 1, 3"), (YQ, Ratio Y/Q, "wheelsets 1, 3"),
            (SigmaY, Sum of guiding forces, "wheelsets 1, 3"),
            (ay, Car body lateral acceleration, "running gears I, II"),
            (az, Car body vertical acceleration, "running gears I, II")
  of        {signal} at {positions}
  filter    LP20
  metric    fisher probability, points cdf_points
  reported  "First factor of the matching probability."

quantity {signal}_mean "{title}, agreement in mean"
  for each  signal, title, positions in (Y, Guiding force, "wheelsets 1, 3"),
            (Q, Vertical wheel force, "wheelsets 1, 3"), (YQ, Ratio Y/Q, "wheelsets 1, 3"),
            (SigmaY, Sum of guiding forces, "wheelsets 1, 3"),
            (ay, Car body lateral acceleration, "running gears I, II"),
            (az, Car body vertical acceleration, "running gears I, II")
  of        {signal} at {positions}
  filter    LP20
  metric    agreement in mean, points cdf_points
  reported  "Second factor of the matching probability."

quantity {signal}_match_{points} "{title}, matching probability at {points} points"
  for each  signal, title, positions in (Y, Guiding force, "wheelsets 1, 3"),
            (Q, Vertical wheel force, "wheelsets 1, 3"), (YQ, Ratio Y/Q, "wheelsets 1, 3"),
            (SigmaY, Sum of guiding forces, "wheelsets 1, 3"),
            (ay, Car body lateral acceleration, "running gears I, II"),
            (az, Car body vertical acceleration, "running gears I, II")
  for each  points in 20, 50, 100
  of        {signal} at {positions}
  filter    LP20
  metric    matching probability, {points} points
  reported  "Shows what the number of points does."

verdict
  validated  when every limit holds
