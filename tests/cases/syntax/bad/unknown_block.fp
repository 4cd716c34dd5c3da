protocol p

quantiy Y_max
  of  Y

friction 0.3
  is  4
