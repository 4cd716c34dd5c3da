protocol other_quantities "Numbers of other quantities that cannot be had, and repeats"
  extends  en14363-2016-annex-t

estimate upper_value "Of the values"
  is  mean + 3 * std

quantity repeated "Misfit of repeats"
  of       Q at wheelset 1
  metric   misfit
  compare  repeats with originals

quantity Q_max
  limit  (share where value <= p80 of repeated) at least 0.8
  limit  (share where value <= p80 of Y_maks) at least 0.7
  limit  (share where value <= upper_value of Y_max) at least 0.6
  limit  (share where value <= each of Y_max) at least 0.5
  limit  (share where value <= meen of Y_max) at least 0.4
  limit  (p80 / (p80 of Y_maks)) at least 0.4
  limit  p70 p80 of repeated

quantity spread "A metric of several"
  of       Q at wheelset 1
  metric   misfit
  compare  simulated with mean of simulated
  limit    p80 1

quantity assessed "Repeats of one record"
  of       Q at wheelset 1
  from     measured
  compare  repeats with originals
  value    p99.85
  limit    p80 60 kN

quantity misspelt "Repeats with one original"
  of          Q at wheelset 1
  compare     repeats with original
  value       p99.85
  difference  signed
  limit       p80 60 kN
