# Differences judged by the uncertainties of both sides.

protocol en-score "Differences of rms values over their uncertainties: E_n, and the comparison error of ASME V&V 20"
  uses     plausibility-signals
  edition  "ISO 13528 and ISO/IEC 17043: E_n; ASME V&V 20-2009: comparison error"
  source   "ASME V&V 20: definition read in a secondary source. E_n from memory; the standards were not to"
           "hand"
  author   "Fishplate"
  scope    "The difference of an rms value over the expanded uncertainties, and over the validation"
           "uncertainty from numerics, input and measurement."
  axis     distance in m
  time     time in s
  note     "Neither text gives a verdict on a model: a difference below the validation uncertainty cannot be"
           "told from noise. The limits are those that the tests of laboratories use."

parameter En_limit "Largest E_n"
  default      1
  range        0.1 to 10
  unconfirmed  "From memory; the standard was not to hand."

parameter coverage "Coverage factor of the validation uncertainty"
  default      2
  range        1 to 3
  unconfirmed  "Read in a secondary source; the standard was not to hand."

place wheelset
  members  1, 2, 3, 4

place side
  members  R, L

place running_gear
  members  I, II

vehicle U_{channel}_{record} "Expanded uncertainty of the rms of {channel}, {record}"
  for each  channel, unit in (Y, kN), (Q, kN), (ay, m/s^2)
  for each  record in measured, simulated
  in        {unit}
  key       uncertainty.{channel}_{record}

vehicle u_{channel}_{part} "Standard uncertainty of the rms of {channel}, {part}"
  for each  channel, unit in (Y, kN), (Q, kN), (ay, m/s^2)
  for each  part in numerical, input
  in        {unit}
  key       uncertainty.{channel}_{part}

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

define u_val_{channel} "Validation uncertainty of {channel}, one standard deviation"
  for each  channel in Y, Q, ay
  is        sqrt(u_{channel}_numerical^2 + u_{channel}_input^2 + (U_{channel}_measured / coverage)^2)

sections
  use  sections

quantity {channel}_En "E_n of {channel}"
  for each    channel in Y, Q, ay
  of          {channel}
  filter      LP20
  value       rms
  difference  |simulated - measured| / hypot(U_{channel}_measured, U_{channel}_simulated)
  limit       each En_limit
  in          -

quantity {channel}_error "Comparison error of {channel}"
  for each    channel in Y, Q, ay
  of          {channel}
  filter      LP20
  value       rms
  difference  signed
  limit       each coverage * u_val_{channel}

verdict
  validated  when every limit holds
  words      within the uncertainty, beyond the uncertainty
