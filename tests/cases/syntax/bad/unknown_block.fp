protocol p

quantiy Y_max
  of  Y
  filter  LP20

friction 0.3
  is  4
