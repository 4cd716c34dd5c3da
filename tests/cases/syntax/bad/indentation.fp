  axis  distance in m
protocol p
  axis  distance in m
    edition  "taken for a continuation"
 time  time in s
note  "not indented"
  quantity Y_max
    of  Y

quantity Q_max
of  Q
