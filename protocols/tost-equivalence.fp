# Equivalence of simulation and measurement: the interval of the mean difference lies within a margin.

protocol tost-equivalence "Equivalence of mean values by two one-sided tests"
  uses    plausibility-signals
  source  "Schuirmann 1987, A comparison of the two one-sided tests procedure and the power approach"
  author  "Fishplate"
  scope   "The mean difference of quasi-static forces and of rms accelerations: both ends of its interval,"
          "each of 95 %, lie within the margin."
  axis    distance in m
  time    time in s
  note    "The margins are choices of this text. With few sites the interval is wide, and a good model is not"
          "shown to be equivalent."

parameter confidence "Confidence of each test"
  default  95 %
  range    50 % to 99.9 %
  source   "Schuirmann 1987: tests of 5 % each"

parameter margin_{channel} "Margin of {channel}"
  for each     channel, margin, low, high in (Y, 1 kN, 0.01 kN, 20 kN), (Q, 1.5 kN, 0.01 kN, 50 kN),
               (ay, 0.03 m/s^2, 0.001 m/s^2, 1 m/s^2)
  default      {margin}
  range        {low} to {high}
  unconfirmed  "A choice of this text."

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

quantity {channel}_equivalence "{channel}: mean difference"
  for each    channel, reducer in (Y, median), (Q, median), (ay, rms)
  of          {channel}
  filter      LP20
  value       {reducer}
  difference  signed
  limit       upper confidence of mean margin_{channel}
  limit       lower confidence of mean margin_{channel}

verdict
  validated  when every limit holds
  words      equivalent, not shown to be equivalent
