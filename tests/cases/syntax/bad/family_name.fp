protocol {name} "A protocol is no family"
  axis  distance in m

place {place}
  members  1, 2

quantity {a b}
  of  Y

quantity Y_{}
  of  Y

quantity {Y
  of  Y
