protocol choices-for-words "A choice in place of the word it stands for"
  extends  en14363-2016-annex-t

remove
  quantity  every

parameter which "Direction of the curves"
  one of   right, left
  default  right

parameter side_of_report "Record that is assessed"
  one of   measured, simulated
  default  measured

parameter treatment "What a fault does"
  one of   note, stop
  default  note

parameter part "Part of the error"
  one of   magnitude, phase
  default  phase

parameter kind_of_pass "Low-pass or high-pass"
  one of   low-pass, high-pass
  default  low-pass

parameter statistic "What is limited"
  one of   std, p95, mean
  default  std

parameter by "What is independent"
  one of   site, section
  default  section

section side_of_road "Which side"
  one of   right, left
  default  which

check words "Nothing is wrong"
  require    length >= 1 m
  otherwise  treatment

verdict
  independent  by

quantity in_curves "Of curves to one side"
  of          Y at wheelset 1
  value       median
  difference  measured
  where       direction is which
  minimum pairs  1
  limit       statistic 50 kN
  limit       median 2/3 of limit of std

quantity of_simulation "The measured value is not looked at"
  of          Y at wheelset 1
  value       median
  difference  simulated
  limit       std 50 kN

quantity assessed "Of one record"
  from    side_of_report
  of      Y at wheelset 1
  filter  kind_of_pass 20 Hz, filter_phase
  value   median when direction is which, otherwise mean
  limit   statistic 50 kN

quantity by_part "A word of a metric"
  of      Y at wheelset 1
  metric  sprague-geers part
  limit   each 0.5
