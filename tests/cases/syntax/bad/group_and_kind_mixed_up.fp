protocol p

quantities Y_max
  of  Y
