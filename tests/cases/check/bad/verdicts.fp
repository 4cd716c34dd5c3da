protocol verdicts "Verdicts that are refused"
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

quantity left "Left wheel"
  of          Y at wheelset 1 and side L
  value       median
  difference  signed
  limit       mean 1 kN

verdict no_such_verdict
  holds  when lopo holds and loop is not lost

verdict no_such_quantity
  of     lef, measured
  holds  when every limit holds

verdict itself
  holds  when itself holds

verdict loop
  holds  when not (round holds)

verdict round
  holds  when at least 1 of itself_not, loop hold

verdict itself_not
  holds  when every limit holds
  words  accepted

verdict three_words
  holds  when every limit holds
  words  yes, no, perhaps

verdict same_words
  holds  when every limit holds
  words  yes, yes

verdict no_word
  holds  when every limit holds
  words  yes,

verdict passed_word
  holds  when every limit holds
  words  "good enough", "valid with remarks"

verdict own_passed_word
  holds  when every limit holds
  words  green, "green for now"

verdict taken_word
  holds  when every limit holds
  words  closed, open

verdict without_rule
  of  left

verdict with_both
  holds      when every limit holds
  judged by  "an engineer"

verdict of_a_person
  of         left
  judged by  "an engineer"

verdict of_verdicts
  of     left
  holds  when itself_not holds

verdict too_many
  holds  when at least 3 of itself_not, itself_not, loop hold

verdict no_count
  holds  when at least 1.5 of itself_not, loop hold

verdict unread
  holds  when loop has itself
