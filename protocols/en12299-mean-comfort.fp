# Mean comfort of passengers from floor accelerations, measured and simulated, five minutes at a time.

protocol en12299-mean-comfort "Mean comfort of passengers in the manner of EN 12299"
  uses        plausibility-signals
  edition     "EN 12299:2009, mean comfort"
  source      "The rule from memory: 95 % values of weighted rms values of 5 s. Weightings Wd and Wk: ISO"
              "2631-1:1997, Table A.1; Wb: as ISO 8041-1 writes it, numbers from memory"
  author      "Fishplate"
  scope       "The index of the lateral and the vertical direction at floor level, of each section of five"
              "minutes: of the measurement, of the simulation, and their difference. The standard gives a"
              "scale and no limit; the limits are the user's."
  axis        time in s
  time        time in s
  leaves out  "The longitudinal direction, which enters the index of the standard as the other two."
  leaves out  "Positions of passengers other than the floor above the running gear."
  note        "An index below 1.5 is called very comfortable, below 2.5 comfortable, below 3.5 medium, below"
              "4.5 uncomfortable; from memory."

parameter vertical_weighting "Weighting of the vertical acceleration"
  default      Wb
  one of       Wb, Wk
  unconfirmed  "Read in secondary sources; the standard was not to hand. Wk is that of ISO 2631-1."

parameter largest_index "Largest index"
  default      2.5
  range        0.5 to 6
  unconfirmed  "The end of `comfortable`, from memory."

parameter largest_difference "Largest difference of the indices"
  default      0.3
  range        0.01 to 3
  unconfirmed  "A choice of this text."

place running_gear
  members  I, II

channel ay "Lateral acceleration at floor level"
  in      m/s^2
  at      each running_gear
  column  "ay_{running_gear}"

channel az "Vertical acceleration at floor level"
  in      m/s^2
  at      each running_gear
  column  "az_{running_gear}"

filter BAND "Band limits of all weightings, 0.4 Hz and 100 Hz"
  step    transfer function poles 0.4 Hz quality 0.70711 zeros 0 Hz
  step    transfer function poles 100 Hz quality 0.70711, plain
  source  "ISO 2631-1:1997, Table A.1"

filter Wd "Lateral weighting"
  step    BAND
  step    transfer function poles 2 Hz quality 0.63 zero 2 Hz
  source  "ISO 2631-1:1997, Table A.1"

filter Wb "Vertical weighting"
  step  BAND
  step  transfer function poles 16 Hz quality 0.63 zero 16 Hz
  step  transfer function poles 4 Hz quality 0.8 zeros 2.5 Hz quality 0.8, gain 0.4

filter Wk "Vertical weighting of ISO 2631-1"
  step    BAND
  step    transfer function poles 12.5 Hz quality 0.63 zero 12.5 Hz
  step    transfer function poles 3.35 Hz quality 0.91 zeros 2.37 Hz quality 0.91, gain (2.37^2/3.35^2)
  source  "ISO 2631-1:1997, Table A.1"

filter VERTICAL
  step  Wb when vertical_weighting is Wb
  step  Wk when vertical_weighting is Wk

filter LATERAL_5S
  step  Wd
  step  sliding rms 5 s every 5 s

define index
  is  6 * hypot(p95, p95 of (ay through LATERAL_5S)) / (1 m/s^2)

check duration "Five minutes"
  require    length >= 300 s
  otherwise  note

sections
  percentiles  linear

quantity index_{side} "Mean comfort index, {side}"
  for each  side in measured, simulated
  of        az
  filter    VERTICAL, then sliding rms 5 s every 5 s
  from      {side}
  value     index
  limit     each largest_index
  in        -

quantity index_difference "Mean comfort index, simulated less measured"
  of          az
  filter      VERTICAL, then sliding rms 5 s every 5 s
  value       index
  difference  simulated - measured
  limit       each largest_difference
  in          -

verdict comfort "Comfort of the measured vehicle"
  of     measured
  holds  when every limit holds
  words  comfortable, not comfortable

verdict virtual "Comfort of the simulated vehicle"
  of     simulated
  holds  when every limit holds
  words  comfortable, not comfortable

verdict model "Model of the comfort"
  of     index_difference
  holds  when every limit holds
