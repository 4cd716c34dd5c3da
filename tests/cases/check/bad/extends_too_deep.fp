protocol deep0 "A long line of ancestors"
  extends  ancestor-1
