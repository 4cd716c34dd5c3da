protocol p "Wheel forces
  extends  "base
  edition  "EN 14363
  source   "A" "B
  axis     distance in m
