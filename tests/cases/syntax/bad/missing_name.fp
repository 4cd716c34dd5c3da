protocol "Without a name"

quantity "Guiding force"
  of  Y
