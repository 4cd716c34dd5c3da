protocol p ""
  edition  ""
  axis

zone 1
  where  # nothing yet
  clause
