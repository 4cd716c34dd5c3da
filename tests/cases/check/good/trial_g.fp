protocol domain "The sections must reach the limits of the application"
  extends  en14363-2016-annex-t

remove
  quantity  every

quantity Y_max "Guiding force, maximum, and the domain it was tested in"
  of          Y at wheelsets 1, 3
  filter      LP20
  value       larger of |p0.15|, |p99.85|
  difference  magnitudes
  limit       std 9 kN
  limit       (maximum of speed) at least 60 km/h
  limit       (maximum of cant_deficiency) at least 40 mm
  limit       (share of sections where speed <= 160 km/h) at least 90 %
