protocol p

sections all
  minimum  12
