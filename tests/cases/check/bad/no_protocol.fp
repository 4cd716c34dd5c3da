quantity x
  limit  std 3 kN
