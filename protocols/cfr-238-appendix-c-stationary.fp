# Public law of the United States, in own words. Numbers to be checked against the edition in force.

protocol cfr-238-appendix-c-stationary "Wheel loads of Tier II equipment at rest on superelevation, in the manner of 49 CFR 238, Appendix C"
  uses     plausibility-signals
  edition  "49 CFR 238, Appendix C"
  source   "49 CFR 238, Appendix C; read in a public copy in 2026"
  author   "Fishplate"
  scope    "Each wheel load at rest on a superelevation of 6 in, over that of the same wheel on level track."
  axis     time in s
  time     time in s
  note     "Check each number against the edition in force."
  note     "The record has the loads on 6 in and, in columns of their own, those of the same wheels on level"
           "track. The superelevation itself is not read."

parameter load_limit "Wheel load on superelevation must be above this share of that on level track"
  default  0.6
  range    0.01 to 1

place wheelset
  members  1, 2, 3, 4

place side
  members  R, L

channel Q "Vertical wheel force on superelevation"
  in      kN
  at      each wheelset and side
  column  "Q_{wheelset}{side}"

channel Q_level "Vertical wheel force on level track"
  in      kN
  at      each wheelset and side
  column  "Q_level_{wheelset}{side}"

plausibility positive "Wheel load on level track"
  of         Q_level
  require    minimum > 1 kN
  otherwise  not used
  cause      "a sign, or a channel that is not connected"

sections
  use  whole records

quantity load "Wheel load on superelevation over that on level track"
  of          Q
  from        measured
  value       mean / mean of Q_level
  limit       each at least load_limit
  in          -
  clause      "49 CFR 238, Appendix C, stationary test"
  paraphrase  "At rest on 6 in of superelevation each wheel carries more than 0.60 of its load on level"
              "track."

clause on_track "Forces of wheels and trucks while running"
  clause     "49 CFR 238, Appendix C, running test"
  judged by  "the person in charge of that test: protocol cfr-238-appendix-c"

verdict
  validated  when every limit holds
  words      within the limits, beyond a limit
