protocol computed "Section data that follow from others"
  extends  en14363-2016-annex-t

section cant_deficiency
  is  1500 mm * speed^2 / (9.81 m/s^2 * radius) - cant when direction is not straight, otherwise 0 mm

section conicity "Equivalent conicity of the section"
  in  -

section class "Class of conicity"
  one of  low, medium, high
  is      low when conicity < 0.1, medium when conicity < wide, otherwise high

section wide "From where on the conicity is high"
  in  -
  is  0.3 when vehicle.category is freight, otherwise 0.25

section fast "Faster than 140 km/h"
  one of  true, false
  is      speed > 140 km/h

quantity ay_max
  limit   maximum 2 m/s^2 for sections where fast
  report  mean for each class
