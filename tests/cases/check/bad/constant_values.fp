# Values that no record can change.
protocol constant-values "Metrics and values that cannot vary"
  extends  en14363-2016-annex-t

parameter weight "A weight that is zero"
  default  0

quantity times_nothing
  of      Y at wheelset 1
  metric  0 * correlation
  limit   each 0.5

quantity by_parameter
  of      Y at wheelset 1
  metric  weight * (correlation + 0.5 * theil_inequality) + 0.3
  limit   each 0.5

quantity less_itself
  of      Y at wheelset 1
  metric  correlation - correlation
  limit   each 0.5

quantity to_the_power_of_nothing
  of      Y at wheelset 1
  metric  correlation^0
  limit   each 1

quantity of_equal_samples
  of      Y at wheelset 1
  metric  rms of (simulated - simulated) + rms of (simulated - measured)
  limit   each 1 kN

quantity no_signal
  of      Y at wheelset 1
  metric  0.5 + weight
  limit   each 1

quantity value_times_nothing
  of          Y at wheelset 1
  value       0 * median
  difference  signed
  limit       std 1 kN

# These can vary, in some sections or for some records.
quantity by_case
  of      Y at wheelset 1
  metric  correlation when correlation > 0.5, otherwise 0
  limit   each at least 0.5

quantity in_curves
  of      Y at wheelset 1
  metric  1 when direction is straight, otherwise correlation
  limit   each at least 0.5

quantity in_steps
  of      Y at wheelset 1
  metric  floor(100 * correlation) / 100
  limit   each at least 0.5
