protocol remove-every "A variant that removes what is not there"
  extends  sprague-geers

remove
  zone      every
  check     every
  limit     every std
  limit     Y_phase median
  limit     {channel}_{part} mean
  quantity  Y_phase Q_phase

quantity {channel}_{part}
  metric  sprague-geers {part}
  filter  LP2O
  limit   each {prt}_limit
