protocol verdict-by-draws "A verdict by draws of the sections"
  extends  en14363-2016-annex-t

remove
  limit  every

quantity Y_qst
  limit  std 1.3 kN
  limit  (share where |value| <= 2 kN) at least 0.85

quantity Y_max
  limit  std 3.5 kN
  limit  mean 4 kN for each zone
  limit  each 12 kN

quantity Q_qst
  limit  (n) at most 13

verdict
  validated  when every limit holds in 90 % of draws

verdict limits "At least five of eight limits"
  of     Y_qst, Y_max
  holds  when at least 5 limits hold in 50 % of draws

verdict quantities "Two of the quantities"
  of     Y_qst, Y_max, Q_qst
  holds  when at least 2 quantities hold in 95 % of draws
