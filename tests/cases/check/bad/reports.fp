# Estimates without a limit that cannot be.
protocol reports "Reports that say nothing"
  extends  en14363-2016-annex-t

sections
  report  total of length in kN for each zone
  report  mean for each zone
  report  3 km
  report  mean of radius for each wheelset
  report  mean of radius for each record
  report  share of sections where radius < 300 m for zone 9
  report  total of lenght
  report  total of length in furlong
  report  mean of speed for each zone
  report  mean of speed for each zone
  report  n

quantity Y_max
  report  each
  report  maximum for each wheelsets and wheelset
  report  maximum in m/s^2
  report  mean + 3 * radius
  report  mean 9 kN

quantity Q_max
  report  (mean of radius) at least 300 m
