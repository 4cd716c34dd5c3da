protocol metric-expressions "What an expression of metrics cannot be"
  extends  sprague-geers

quantity in_words
  of      Y at wheelset 1
  metric  0.4 * correlation + 0.6 * theil inequality
  limit   each 1

quantity hyphens
  of      Y at wheelset 1
  metric  root-mean-square difference / measured(rms)
  limit   each 1

quantity of_which_side
  of      Y at wheelset 1
  metric  root_mean_square_difference / rms
  limit   each 1

quantity metric_of_one_side
  of      Y at wheelset 1
  metric  1 - measured(correlation)
  limit   each 1

quantity without_band
  of      Y at wheelset 1
  metric  1 - coherence
  limit   each 1

quantity too_many
  of      Y at wheelset 1
  metric  2 * matching_probability(50, 60)
  limit   each 1

quantity band_of_length
  of      Y at wheelset 1
  metric  coherence from 0.1 1/m to 0.3 1/m
  limit   each 1

quantity band_upside_down
  of      Y at wheelset 1
  metric  coherence from 3 Hz to 1 Hz
  limit   each 1

quantity unlike
  of      Y at wheelset 1
  metric  root_mean_square_difference + correlation
  limit   each 1 kN

quantity another_signal
  of      Y at wheelset 1
  metric  rms of (simulated - Q)
  limit   each 1 kN

quantity filtered
  of      Y at wheelset 1
  metric  rms of (simulated through LP20)
  limit   each 1 kN

quantity after_a_window
  of      Y at wheelset 1
  filter  LP20, then sliding mean 2 m every 0.5 m
  metric  rms of (simulated - measured) / 2
  limit   each 1 kN

quantity nothing_taken
  of      Y at wheelset 1
  metric  1 + 2
  limit   each 1

quantity in_value
  of          Y at wheelset 1
  value       rms of (simulated - measured)
  difference  signed
  limit       std 1 kN

quantity metric_in_value
  of          Y at wheelset 1
  value       rms * coherence(1 Hz, 3 Hz)
  difference  signed
  limit       std 1 kN

quantity unknown
  of      Y at wheelset 1
  metric  1 - theil_inequallity
  limit   each 1

quantity wrong_side
  of      Y at wheelset 1
  metric  matching_probability(50)
  limit   each 0.5
