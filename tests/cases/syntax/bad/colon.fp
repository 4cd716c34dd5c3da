protocol p
  axis: distance in m
  edition = "1"
