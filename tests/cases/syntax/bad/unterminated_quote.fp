protocol p
  extends  "base
  axis     distance in m
