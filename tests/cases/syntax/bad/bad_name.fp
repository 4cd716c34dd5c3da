protocol p

quantity Y/Q_max
  of  Y

quantity Größe "Size"
  of  Q
