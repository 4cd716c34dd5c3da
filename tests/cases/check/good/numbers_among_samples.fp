protocol numbers-among-samples "Numbers of the section among samples, and windows in a value"
  extends  en14363-2016-annex-t

filter SLIDING "Sliding mean over 2 m"
  step  LP20
  step  sliding mean 2 m every 0.5 m

signal Y_about_mean "Guiding force about its mean in the section"
  at  each wheelset and side
  is  Y - mean of Y
  in  kN

quantity Y_dynamic "Guiding force about its mean, rms"
  of          Y_about_mean at wheelset 1
  filter      LP20
  value       rms
  difference  signed
  limit       std 9 kN

quantity Y_sliding "Largest sliding mean over the rms"
  of          Y at wheelset 1
  value       maximum of (Y through SLIDING) / rms of (Y - median of Y)
  difference  signed
  limit       std 9

quantity Y_without_mean "Difference without its mean"
  of      Y at wheelset 1
  filter  LP20
  metric  rms of (simulated - measured - mean of (simulated - measured)) / std of measured
  limit   p95 9

quantity Y_windows "Ratio of the largest sliding means"
  of      Y at wheelset 1
  filter  SLIDING
  metric  maximum of simulated / maximum of measured
  limit   p95 9
