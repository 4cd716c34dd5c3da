protocol between "Limits between two edges"
  extends  en14363-2016-annex-t

parameter between "A number of this name"
  default  3 kN

quantity Y_max
  limit  median between -2 kN and 3 kN, doubled when vehicle.category is freight for each zone
  limit  each between -(12 kN) and 10 kN
  limit  p95 between
  limit  p5 between between - 4 kN and 0.5 * limit of p95

quantity Q_max
  limit  (count where |value| > 2 kN) between 0 and 100
