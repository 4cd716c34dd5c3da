protocol variant "A variant of itself"
  extends  "extends_itself.fp"
