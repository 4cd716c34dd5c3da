protocol not-finite "Constants that have no value, and slips in limits"
  extends  en14363-2016-annex-t

signal Yd "A division by zero inside a signal"
  is  Y / 0
  at  each wheelset and side

signal Ye "A divisor that comes to zero"
  is  Y / (1 - 1)
  at  each wheelset and side

signal Yf "No real number"
  is  Y * sqrt(0 - 1)
  at  each wheelset and side

quantity Y_max
  limit  max 8 kN

quantity Y_qst
  limit  std 5,5 kN
