protocol family-variant "A variant with slips in families of its parent"
  extends  sprague-geers

remove
  quantity  {channel}_{prt}
  quantity  Y_phse
  quantity  every
  zone      every
  limit     every std
  limit     {channel}_{part} mean

quantity {chanel}_{part}
  filter  LP20

quantity {channel}_{part}
  filter  LP20
