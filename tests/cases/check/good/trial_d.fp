protocol both_tests "On-track assessment of the measured and of the simulated vehicle, side by side"
  extends  en14363-2016-annex-t

remove
  quantity  every

parameter I_adm "Admissible cant deficiency"
  default  130 mm

estimate safety "One-dimensional estimate"
  is  mean + 3 * std

estimate safety_2d "Two-dimensional estimate"
  is  prediction over cant_deficiency at 1.1 * I_adm, confidence 99 %

quantity SigmaY_{record} "Sum of guiding forces, {record}"
  for each  record in measured, simulated
  of        SigmaY at wheelsets 1, 3
  filter    LP20, then sliding mean 2 m every 0.5 m
  from      {record}
  value     -p0.15 when direction is not left
  value     p99.85 when direction is not right
  limit     safety 10 kN + 2/3 * Q0 for each zone and wheelset
  limit     safety_2d 10 kN + 2/3 * Q0 for each zone and wheelset where direction is not straight

quantity Y_qst_{record} "Quasi-static guiding force, {record}"
  for each  record in measured, simulated
  of        Y at wheelsets 1, 3 and side outer when direction is not straight
  filter    LP20
  from      {record}
  value     -turn * median
  limit     mean 30 kN + 10500 kN * m / (mean of radius) for zone 4 and each wheelset
