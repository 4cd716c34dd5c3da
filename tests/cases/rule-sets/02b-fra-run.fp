protocol fra-213-333-run "FRA 213.333, car body in a run"
  extends  "02-fra-213-333.fp"

remove
  quantity  net_axle_lv
  quantity  truck_side_lv

# the run has no channel of the truck: the same rule for the car body, 4 s
parameter WT
  default  4 s

sections
  use  sections

quantity truck_lateral
  of     ay
  limit  each 0.1 gn
