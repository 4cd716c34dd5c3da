protocol products "A number and a name without the sign between them"
  extends  en14363-2016-annex-t

parameter k_1 "Factor"
  default  1.2

quantity Y_max
  limit  std 2 Q0 / 3
  limit  mean 2 Q0 / 3 for each zone
  limit  p80 (1 kN + 2 k_1 * 3 kN), doubled when small

quantity Q_max
  limit  (mean + 3 std) 9 kN
  limit  p80 4 kn

quantity az_max
  value  2 rms / 3
