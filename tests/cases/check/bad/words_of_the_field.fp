protocol words-of-the-field "Words that other tools have, and what is meant by them"
  extends  en14363-2016-annex-t

section conicity
  in  -

define class
  is  low when conicity < 0.1, medium when conicity < 0.25, otherwise high

quantity at_a_frequency
  of          ay
  value       psd at 3 Hz
  difference  signed
  limit       std 1

quantity in_decibel
  of      ay
  filter  LP20
  metric  20 * log10(root_mean_square_ratio)
  limit   each 3 dB

quantity step_in_an_expression
  of      ay
  metric  simulated(rms of (ay through low-pass 10 Hz)) - measured(rms of (ay through LP20))
  limit   each 1 m/s^2

quantity filtered_difference
  of      ay
  metric  rms of ((simulated - measured) through LP20)
  limit   each 3 m/s^2

quantity grams
  from   measured
  of     ay
  value  range
  limit  each 0.65 g

quantity grams_added
  from   measured
  of     ay
  value  range + 0.2 g
  limit  each 3 m/s^2

quantity sum_of_signals
  of          Y + Q
  value       rms
  difference  signed
  limit       mean 3 kN

quantity by_class
  of          ay
  value       average
  difference  signed
  limit       std 1 m/s^2 for each class

quantity magnitude
  of          ay
  value       abs(p99.85)
  difference  signed
  limit       std 1 m/s^2
