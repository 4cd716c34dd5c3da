protocol metric-expressions "Metrics in expressions, numbers of both sides' samples"
  extends  sprague-geers

remove
  quantity  every

parameter share "Weight of the correlation"
  default  0.4

quantity one_by_name "A metric by the name of its function is the metric: its best value is known"
  of      Y at wheelset 1
  filter  LP20
  metric  theil_inequality
  limit   each 0.3

quantity points_by_name "Its option in parentheses"
  of      Y at wheelset 1
  filter  LP20
  metric  matching_probability(50)
  limit   each at least 0.05

quantity weighted "Two metrics, weighted by a parameter"
  of      Y at wheelset 1
  filter  LP20
  metric  share * correlation + (1 - share) * (1 - theil_inequality)
  limit   each at least 0.7

quantity normalised "Root-mean-square difference over the measured rms"
  of      Y at wheelset 1
  filter  LP20
  metric  root_mean_square_difference / measured(rms)
  limit   each 30 %

quantity own_formula "The same of samples"
  of      Y at wheelset 1
  filter  LP20
  metric  rms of (simulated - measured) / rms of measured
  limit   p95 0.3

quantity mean_error "Mean of magnitudes"
  of      Y at wheelset 1
  filter  LP20
  metric  mean of |simulated - measured|
  limit   maximum 3 kN

quantity outside "Share of the samples that differ by more than 2 kN"
  of      Y at wheelset 1
  filter  LP20
  metric  mean of (0.5 * (1 + sign(|simulated - measured| - 2 kN)))
  limit   each 5 %

quantity moved "What is left after the simulation is moved by half a metre"
  of      Y at wheelset 1
  filter  LP20
  metric  rms of (shifted(simulated, 0.5 m) - measured) / rms of measured
  limit   p95 0.5

quantity slopes "Difference of the slopes"
  of      Y at wheelset 1
  filter  LP20
  metric  rms of (derivative(simulated) - derivative(measured))
  in      kN/m
  limit   p95 3 kN/m

quantity follows "Coherence"
  of      ay at running gear I
  metric  coherence from 1 Hz to 3 Hz
  limit   median at least 0.5

quantity follows_and_is_like "Coherence in an expression, and the size of another signal at the same place"
  of      Y at wheelset 1
  metric  coherence(1 Hz, 3 Hz) * smaller of 1, measured(rms of Q) / simulated(rms of Q)
  limit   median at least 0.3

plausibility moved_record "Both sides' samples in a plausibility rule"
  of       Y at wheelset 1
  require  rms of (simulated - measured) <= 3 * measured(rms)
