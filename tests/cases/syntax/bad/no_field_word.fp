protocol p
  "Wheel forces"
  2 kN

"quantity" Y
