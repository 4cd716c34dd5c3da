protocol conditions "Conditions on samples and on single values"
  axis  distance in m
  time  time in s

channel Y "Guiding force"
  in      kN
  column  "Y_1R"

channel Q "Vertical wheel force"
  in      kN
  column  "Q_1R"

channel ay "Lateral acceleration of the car body"
  in      m/s^2
  column  "ay_I"

section direction "Direction of the curve"
  one of  straight, right, left

parameter level "Level of the wheel force"
  default  60 kN
  range    40 kN to 80 kN

define relative "A deviation over a scale"
  of  x, scale
  is  |x| / scale

define from_level "What is above a level, with the level in its place below"
  of  x, low
  is  x when x > low, otherwise low

estimate enough "Mean and scatter, of enough values"
  is  mean + 3 * std when n > 5 and std > 0.1 kN, otherwise |mean|

quantity low_share "Share of the samples with a low wheel force"
  from    measured
  of      Q
  value   share where Q < 52 kN and ay > 0 m/s^2
  report  mean

quantity run "Longest run below the level"
  from    measured
  of      Q
  value   longest run where Q < level
  report  mean

quantity run_time "The same in time"
  from    measured
  of      Q
  value   longest run in time where not (Q >= level)
  report  mean

quantity masked "Mean guiding force where the wheel force is high"
  from    measured
  of      Q
  value   mean of (Y when Q > 58 kN)
  report  mean

quantity chosen "One of three, by samples and by section"
  from    measured
  of      Y
  value   rms of (Y when Q > level, 0 kN when Q > 50 kN and direction is right, otherwise -Y / 2)
  report  mean

quantity raised "A function of samples"
  from    measured
  of      Y
  value   rms of from_level(Y, 1 kN)
  report  mean

quantity outside "Share of the samples that differ"
  of      Y
  metric  share where |simulated - measured| > 2 kN
  report  mean

quantity masked_both "Difference where the measurement is above 1 kN"
  of      Y
  metric  rms of (simulated - measured when measured > 1 kN)
  report  mean

quantity mixed "Relative above a threshold, absolute below"
  of          Y
  value       p99.85
  difference  oriented / 1.2
  limit       each larger of 10 % * |measured|, 2 kN
  limit       (share where |value| <= larger of 0.1 * |measured|, 2 kN) at least 0.5
  limit       (count where |value| > 2 kN) at most 20
  limit       (mean of |value|) 5 kN
  limit       enough 20 kN
  limit       std 2 * low_mean
  report      mean of relative(value, 2 kN)
  report      rms of (measured - simulated)

estimate low_mean "An estimate as a bound"
  is  mean of |value|
