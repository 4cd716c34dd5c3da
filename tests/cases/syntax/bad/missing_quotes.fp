protocol p Wheel forces
  edition  EN 14363:2016
  source   "Table" 1
  scope    “typographic”
