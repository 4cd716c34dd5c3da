protocol both-sides "Numbers of both sides' signals, and signals along the axis"
  extends  en14363-2016-annex-t

remove
  quantity  every

signal Y_moved "Guiding force 2 m further on"
  at  each wheelset and side
  is  shifted(Y, 2 m)
  in  kN

signal Y_slope "Guiding force, slope"
  at  each wheelset and side
  is  derivative(Y)
  in  kN/m

signal jerk "Lateral jerk of the car body"
  at  each running gear
  is  derivative(ay, time)

signal sway_speed "Integral of the lateral acceleration over time"
  at  each running gear
  is  integral(ay, time)

signal Y_area "Guiding force, integral over the distance"
  at  each wheelset and side
  is  integral(Y)
  in  kN*m

# ---- against the vectors of the metrics, low-pass filtered

quantity {channel}_coherence_{low}_{high} "{channel}, coherence from {low} Hz to {high} Hz"
  for each  channel in Y, Q and low, high in (1, 2), (2, 4), (4, 8), (8, 16)
  of        {channel} at wheelsets 1, 3
  filter    LP20
  metric    coherence from {low} Hz to {high} Hz
  limit     minimum at least 0

quantity {channel}_nrmse "{channel}, root-mean-square difference over the measured rms"
  for each  channel in Y, Q
  of        {channel} at wheelsets 1, 3
  filter    LP20
  metric    rms of (simulated - measured) / rms of measured
  limit     p95 1

quantity {channel}_nrmse_of_metric "{channel}, the same by the metric"
  for each  channel in Y, Q
  of        {channel} at wheelsets 1, 3
  filter    LP20
  metric    root_mean_square_difference / measured(rms)
  limit     p95 1

quantity {channel}_nrmse_range "{channel}, root-mean-square difference over the measured range"
  for each  channel in Y, Q
  of        {channel} at wheelsets 1, 3
  filter    LP20
  metric    root_mean_square_difference / measured(range)
  limit     p95 1

quantity {channel}_rating "{channel}, two metrics weighted"
  for each  channel in Y, Q
  of        {channel} at wheelsets 1, 3
  filter    LP20
  metric    0.4 * correlation + 0.6 * (1 - theil_inequality)
  limit     minimum at least -1

quantity {channel}_octave_{low}_{high} "{channel}, ratio of the rms in one octave"
  for each    channel in Y, Q and low, high in (1, 2), (2, 4), (4, 8), (8, 16)
  of          {channel} at wheelsets 1, 3
  filter      LP20, then band-pass {low} Hz to {high} Hz
  value       rms
  difference  simulated / measured
  limit       minimum at least 0

# ---- against NumPy, as recorded

plausibility apart "Difference of the samples, which is never zero"
  of       Y at wheelsets 1, 3
  require  rms of (simulated - measured) <= 0 kN

quantity slope_rms
  of          Y_slope at wheelsets 1, 3
  value       rms
  difference  signed
  limit       std 1000 kN/m

quantity jerk_rms
  of          jerk
  value       rms
  difference  signed
  limit       std 1000 m/s^3

quantity speed_gained
  of          sway_speed
  value       last - first
  difference  signed
  limit       std 1000 m/s

quantity area
  of          Y_area at wheelsets 1, 3
  value       last - first
  difference  signed
  limit       std 10000 kN*m

quantity moved
  of          Y_moved at wheelsets 1, 3
  value       mean
  difference  signed
  limit       std 1000 kN

quantity Y_over_Q
  of          Y at wheelsets 1, 3
  value       slope over Q
  difference  signed
  limit       std 1000

quantity Y_over_Q_named
  of          Y at wheelsets 1, 3
  value       slope of Y over Q
  difference  signed
  limit       std 1000

quantity mean_difference
  of      Y at wheelsets 1, 3
  metric  mean of |simulated - measured|
  limit   maximum 1000 kN

quantity difference_moved
  of      Y at wheelsets 1, 3
  metric  rms of (shifted(simulated, 2 m) - measured)
  limit   maximum 1000 kN

quantity difference_of_slopes
  of      Y at wheelsets 1, 3
  metric  p90 of |derivative(simulated) - derivative(measured)|
  limit   maximum 1000 kN/m

# ---- numbers among samples, and windows in a value

signal Y_about_mean "Guiding force about its mean in the section"
  at  each wheelset and side
  is  Y - mean of Y
  in  kN

filter RMS_2M "Sliding rms over 2 m"
  step  sliding rms 2 m every 0.5 m

quantity about_mean "Guiding force about its mean, rms"
  of          Y_about_mean at wheelsets 1, 3
  value       rms
  difference  signed
  limit       std 100 kN

quantity largest_rms_2m "Guiding force, largest rms over 2 m"
  of          Y at wheelsets 1, 3
  value       maximum of (Y through RMS_2M)
  difference  signed
  limit       std 100 kN

quantity difference_about_mean "Guiding force, rms of the difference without its mean"
  of      Y at wheelsets 1, 3
  metric  rms of (simulated - measured - mean of (simulated - measured))
  limit   p95 100 kN

quantity ratio_of_windows "Guiding force, ratio of the largest rms over 2 m"
  of      Y at wheelsets 1, 3
  filter  RMS_2M
  metric  maximum of simulated / maximum of measured
  limit   p95 100
