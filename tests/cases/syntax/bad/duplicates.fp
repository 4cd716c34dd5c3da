protocol p
  edition  "1"
  edition  "2"
  note     "Notes may"
  note     "be several."

quantity Y_max
  of     Y
  limit  std 9 kN
  limit  mean 6 kN

signal Y_max
  is  Y

quantity Y_max
  of  Q

verdict
  validated  when every limit holds

verdict
  validated  when every limit holds
