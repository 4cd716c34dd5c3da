protocol trial-c-metrics "Metrics of time histories, alone and combined"
  extends  sprague-geers

parameter corridor_width "Half width of the corridor"
  default  5 kN

remove
  quantity  every

quantity {name} "{title}"
  for each  name, wording, bound, title in
            (russell, russell comprehensive, 0.4, Russell), (theil, theil inequality, 0.4, Theil),
            (area, area between distributions, 5 kN, Area), (r, correlation, at least 0.6, Correlation)
  of        Y at wheelset 1 and side L
  filter    LP20
  metric    {wording}
  limit     each {bound}

quantity combined "Correlation and Theil, weighted"
  of      Y at wheelset 1 and side L
  filter  LP20
  metric  0.4 * correlation + 0.6 * (1 - theil_inequality)
  limit   each at least 0.6

quantity knowles_gear "Weighted magnitude and phase after Knowles and Gear, of Sprague and Geers' parts"
  of      Y at wheelset 1 and side L
  filter  LP20
  metric  sqrt((10 * sprague_geers_magnitude^2 + 2 * sprague_geers_phase^2) / 12)
  limit   each 0.3

quantity nrmse_rms "Root-mean-square difference over the measured rms"
  of      Y at wheelset 1 and side L
  filter  LP20
  metric  root_mean_square_difference / measured(rms)
  limit   each 60 %

quantity nrmse_range "Root-mean-square difference over the measured range"
  of      Y at wheelset 1 and side L
  filter  LP20
  metric  rms of (simulated - measured) / measured(range)
  limit   each 10 %

quantity corridor "Share of the samples in a corridor of 5 kN"
  of      Y at wheelset 1 and side L
  filter  LP20
  metric  mean of (0.5 + 0.5 * sign(corridor_width - |simulated - measured|))
  limit   each at least 80 %

quantity error_p95 "95 % of the samples differ by less"
  of      Y at wheelset 1 and side L
  filter  LP20
  metric  p95 of |simulated - measured|
  limit   each 10 kN

quantity moved "Correlation is not enough: what is left after the best known shift"
  of      Y at wheelset 1 and side L
  filter  LP20
  metric  rms of (shifted(simulated, 0.25 m) - measured) / rms of measured
  limit   each 60 %

quantity slopes "Difference of the slopes over the measured slopes"
  of      Y at wheelset 1 and side L
  filter  LP20
  metric  rms of (derivative(simulated) - derivative(measured)) / rms of derivative(measured)
  limit   each 100 %

quantity coherence_{low}_{high} "Coherence from {low} Hz to {high} Hz"
  for each  low, high in (1, 2), (2, 4), (4, 8)
  of        ay
  metric    coherence from {low} Hz to {high} Hz
  limit     median at least 0.3

quantity octave_{middle} "Level difference in the octave of {middle} Hz, dB"
  for each    middle, low, high in (1, 0.707, 1.414), (2, 1.414, 2.828), (4, 2.828, 5.657), (8, 5.657, 11.314)
  of          ay
  filter      band-pass {low} Hz to {high} Hz
  value       rms
  difference  20 * log10(simulated / measured)
  limit       each 3

quantity kurtosis "Kurtosis of the vertical acceleration"
  of          az
  value       mean of (az_free^4) / std^4
  difference  signed
  limit       each 2

signal az_free "Vertical acceleration above 0.4 Hz"
  is  az through HP
  at  each running gear

filter HP
  step  high-pass 0.4 Hz
