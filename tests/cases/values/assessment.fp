protocol assessment "On-track assessment of the measured vehicle"
  extends  en14363-2016-annex-t
  scope    "Estimated maxima per zone and wheelset, one- and two-dimensional and multiple regression."

remove
  quantity  Y_qst
  quantity  Q_qst
  quantity  YQ_qst
  quantity  SigmaY_qst
  quantity  Y_max
  quantity  Q_max
  quantity  YQ_max
  quantity  SigmaY_max
  quantity  ay_rms
  quantity  az_rms
  quantity  ay_max
  quantity  az_max

parameter I_adm "Admissible cant deficiency"
  default  130 mm

signal kYQ_left "Ratio Y/Q of the left wheel, positive towards its flange"
  at     each wheelset
  is     -YQ at side L
  named  "kYQ_{wheelset}L"

signal kYQ_right "Ratio Y/Q of the right wheel, positive towards its flange"
  at     each wheelset
  is     YQ at side R
  named  "kYQ_{wheelset}R"

define curving "Curvature of the section, 0 on straight track"
  is  0 1/m when direction is straight, otherwise 1/radius

estimate safety "One-dimensional estimate, running safety"
  is  mean + 3.0 * std

estimate safety_2d "Two-dimensional estimate, running safety"
  is  prediction over cant_deficiency at 1.1 * I_adm, confidence 99 %

estimate safety_multiple "Multiple regression, running safety"
  is  prediction over speed, cant_deficiency, curving at mean of speed, 1.1 * I_adm, mean of curving, confidence 99 %

estimate loading "One-dimensional estimate, track loading"
  is  mean + 2.2 * std

estimate loading_2d "Two-dimensional estimate, track loading"
  is  prediction over cant_deficiency at 1.1 * I_adm, confidence 95 %

estimate quasi_static_2d "Regression, quasi-static"
  is  regression over cant_deficiency at 1.1 * I_adm

quantity SigmaY "Sum of guiding forces, running safety"
  from    measured
  of      SigmaY at wheelsets 1, 2, 3, 4
  filter  LP20, then sliding mean 2 m every 0.5 m
  value   -p0.15 when direction is not left
  value   p99.85 when direction is not right
  limit   safety 10 kN + 2/3 * Q0 for each zone and wheelset
  limit   safety_2d 10 kN + 2/3 * Q0 for each zone and wheelset
  limit   safety_multiple 10 kN + 2/3 * Q0 for each zone and wheelset
  limit   each 10 kN + 2/3 * Q0

quantity YQ "Ratio Y/Q, running safety"
  from    measured
  of      kYQ_left at wheelsets 1, 2, 3, 4 when direction is not left
  of      kYQ_right at wheelsets 1, 2, 3, 4 when direction is not right
  filter  LP20, then sliding mean 2 m every 0.5 m
  value   p99.85
  limit   safety 0.8 for each zone and wheelset
  limit   safety_2d 0.8 for each zone and wheelset

quantity Q "Vertical wheel force, track loading"
  from    measured
  of      Q at wheelsets 1, 2, 3, 4 and side outer when direction is not straight
  of      Q at wheelsets 1, 2, 3, 4 when direction is straight
  filter  LP20
  value   p99.85
  limit   loading 90 kN + Q0 for each zone and wheelset
  limit   loading_2d 90 kN + Q0 for each zone and wheelset
  limit   (upper 95 % of mean) 90 kN + Q0 for each zone and wheelset
  limit   (upper 95 % of p80) 90 kN + Q0 for each zone

quantity Y_qst "Quasi-static guiding force"
  from    measured
  of      Y at wheelsets 1, 2, 3, 4 and side outer when direction is not straight
  filter  LP20
  value   -turn * median
  limit   mean 30 kN + 10500 kN * m / (mean of radius) for zone 4 and each wheelset
  limit   mean 60 kN for each zone and wheelset where direction is not straight and zone is not 4
  limit   quasi_static_2d 60 kN for each zone and wheelset where direction is not straight
  limit   (share where value <= 60 kN) at least 0.5

quantity B_qst "Combined rail loading"
  from    measured
  of      Y at wheelsets 1, 2, 3, 4 and side outer when direction is not straight
  filter  LP20
  value   -turn * median + 0.83 * median of Q at side outer through LP20
  limit   mean 180 kN for each zone and wheelset where direction is not straight
