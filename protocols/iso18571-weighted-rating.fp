# One grade from the ratings of several channels.

protocol iso18571-weighted-rating "Rating of time histories in the manner of ISO/TS 18571, weighted over channels, with its grades"
  uses     plausibility-signals
  edition  "ISO/TS 18571:2014; ISO/TR 16250:2013 for the grades"
  source   "Rating: ISO/TS 18571, as objective-rating-metrics 1.3 computes it. Grades from memory"
  author   "Fishplate"
  scope    "The rating of each section and position, its mean for each channel, and the weighted mean."
  axis     distance in m
  time     time in s
  note     "The standard is written for non-ambiguous signals of crash tests, sampled at 10 kHz. The weights"
           "of the channels are this text's own."

parameter weight_{channel} "Weight of {channel}"
  for each     channel, weight in (Y, 0.5), (Q, 0.3), (ay, 0.2)
  default      {weight}
  range        0 to 1
  unconfirmed  "A choice of this text. The weights add up to 1."

parameter {grade}_above "Weighted rating above which it is {grade}"
  for each     grade, rating in (excellent, 0.94), (good, 0.8), (fair, 0.58)
  default      {rating}
  range        0 to 1
  unconfirmed  "From memory; the standard was not to hand."

place wheelset
  members  1, 2, 3, 4

place side
  members  R, L

place running_gear
  members  I, II

channel Y "Lateral wheel force"
  in      kN
  at      each wheelset and side
  column  "Y_{wheelset}{side}"

channel Q "Vertical wheel force"
  in      kN
  at      each wheelset and side
  column  "Q_{wheelset}{side}"

channel ay "Lateral acceleration of the car body"
  in      m/s^2
  at      each running_gear
  column  "ay_{running_gear}"

filter LP20 "Low-pass"
  step  low-pass 20 Hz, order 4, zero-phase

sections
  use  sections

quantity {channel}_rating "Rating of {channel}"
  for each  channel in Q, ay
  of        {channel}
  filter    LP20
  metric    iso18571 overall
  reported  "Enters the weighted rating."

quantity rating "Rating of Y, and weighted rating of all channels"
  of       Y
  filter   LP20
  metric   iso18571 overall
  report   weighted_rating
  outcome  excellent: holds when weighted_rating > excellent_above
  outcome  good: holds when weighted_rating > good_above
  outcome  fair: holds when weighted_rating > fair_above
  outcome  poor: fails

estimate weighted_rating "Weighted rating of all channels"
  is  (weight_Y * mean + weight_Q * mean of Q_rating + weight_ay * mean of ay_rating) / (weight_Y + weight_Q + weight_ay)

verdict
  validated  when every limit holds
