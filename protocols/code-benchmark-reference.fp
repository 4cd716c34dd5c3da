# Codes against a reference solution: as code-benchmark, and nothing here is taken from published benchmarks either.

protocol code-benchmark-reference "Comparison of simulation codes with a reference solution"
  extends  code-benchmark
  source   "Kind of comparison: ERRI B176; Iwnicki, Manchester Benchmarks for Rail Vehicle Simulation,"
           "Vehicle System Dynamics 30 (1998), 295-313. The published numbers were not to hand."
  author   "Fishplate"
  scope    "As code-benchmark, with the deviation of each code from a reference in place of the spread. The"
           "reference is the most accurate solution, or the code that the others are compared with. It stands"
           "in the place of the measured records."
  note     "Measured, in this report, is the reference: no record of a vehicle is compared."

quantity {force}_qst "{title}, quasi-static value: deviation from the reference"
  for each  force, title in (Y, Guiding force), (Q, Vertical wheel force)
  compare   simulated with measured

quantity {force}_max "{title}, maximum: deviation from the reference"
  for each  force, title in (Y, Guiding force), (Q, Vertical wheel force)
  compare   simulated with measured

quantity {acceleration}_{what} "{title}, {what}: deviation from the reference"
  for each  acceleration, title in (ay, Car body lateral acceleration), (az, Car body vertical acceleration)
  for each  what in rms, max
  compare   simulated with measured

quantity {channel}_history "{title}, difference of the time histories"
  for each  channel, title, place,
            tolerance in (Y, Guiding force, wheelsets evaluated_wheelsets and each side, force_tolerance),
            (Q, Vertical wheel force, wheelsets evaluated_wheelsets and each side, force_tolerance),
            (ay, Car body lateral acceleration, running gears evaluated_gears, acceleration_tolerance),
            (az, Car body vertical acceleration, running gears evaluated_gears, acceleration_tolerance)
  symbol    "{channel}_history"
  of        {channel} at {place}
  filter    LP20
  metric    root-mean-square difference
  limit     each {tolerance} for each record
