protocol variant "A variant with slips"
  extends  en14363-2016-annex-t

remove
  quantity  az_mx
  limit     az_max median
  quantity  ay_rms az_rms
  zone      7

parameter section_per_zone
  source  "Proposal"

quantity ay_mx
  limit  std 0.3 m/s^2

quantity Y_max
  metric  correlation

zone 6 "One more zone without a condition"
  minimum sections  3.5
