protocol several-verdicts "Several verdicts"
  axis  distance in m
  time  time in s

place wheelset
  members  1, 2

place side
  members  R, L

section zone "Test zone"
  one of  zones

section direction "Direction"
  one of  right, left, straight

channel Y "Guiding force"
  in      kN
  at      each wheelset and side
  column  "Y_{wheelset}{side}"

zone 1 "Straight track"
  where             direction is straight
  minimum sections  1

zone 2 "Curves"
  where             direction is not straight
  minimum sections  2

sections
  zone  zone

quantity right "Right wheel"
  of          Y at wheelset 1 and side R
  value       median
  difference  signed
  limit       mean 1 kN

quantity left "Left wheel"
  of          Y at wheelset 1 and side L
  value       median
  difference  signed
  limit       mean 1 kN

quantity measured_right "Right wheel, measured"
  of     Y at wheelset 1 and side R
  from   measured
  value  median
  limit  mean 10 kN

quantity simulated_right "Right wheel, simulated"
  of     Y at wheelset 1 and side R
  from   simulated
  value  median
  limit  mean 10 kN

verdict measured_test "Acceptance by the measurement"
  of     measured
  holds  when every limit holds
  words  accepted, not accepted

verdict virtual_test "Acceptance by the simulation"
  of     simulated
  holds  when every limit holds
  words  accepted, not accepted

verdict agrees "Virtual test against measured test"
  holds  when virtual_test is measured_test

verdict close "Simulation near the measurement"
  of     compared
  holds  when at least 1 quantities hold
  words  near, far

verdict inspection "Condition of the contact surfaces"
  judged by  "the responsible test engineer"
  words      worn, as new
  clause     "4.2"
  note       "Rail and wheel are looked at after the runs."

verdict both "Both tests, unless they differ"
  holds  when (measured_test holds and virtual_test holds or not (agrees holds)) and close holds

verdict enough "Two of three"
  holds  when at least 2 of measured_test, virtual_test, close hold

verdict released "Released"
  holds  when both holds and inspection does not hold

verdict at_{part} "A verdict of a family"
  for each  part in left, right
  of        {part}
  holds     when at least 1 limit holds
