protocol gbt-5599-2019 "GB/T 5599-2019 style dynamic performance, measured against simulated"
  extends  "base.fp"
  note     "The ride index is by the weighting filter (ERRI B153 form): Wz = 4.42 a_w^0.3, not by the"
           "spectrum."

parameter k_lateral
  default  0.73730811351602

parameter k_vertical
  default  0.5882458219096603

signal derail "Derailment coefficient"
  is  |Y / Q|
  at  each wheelset and side
  in  -

signal DP "Wheel unloading rate"
  is  |Q - Q0| / Q0
  at  each wheelset and side
  in  -

filter BW_{dir} "Sperling weighting, {dir}"
  for each  dir, k in (lateral, k_lateral), (vertical, k_vertical)
  step      transfer function pole 0.7236876838804673 Hz zero 0 Hz, gain {k}
  step      transfer function poles 6.127742397935874 Hz quality 0.9006768282515845 zero 5.52955694427682 Hz

define sperling "Ride index"
  is  4.42 * (rms / (1 m/s^2))^0.3

quantity Wz_{dir} "Ride index, {dir}"
  for each  dir, ch in (lateral, ay), (vertical, az)
  of        {ch}
  filter    BW_{dir}
  from      measured
  value     sperling
  limit     each 2.5 when category is passenger, otherwise 3.5
  in        -

quantity derailment "Derailment coefficient"
  of      derail
  filter  low-pass 40 Hz, then sliding mean 2 m every 0.5 m
  from    measured
  value   maximum
  limit   each 1 when direction is not straight and radius <= 400 m, otherwise 0.8

quantity unloading
  of      DP
  filter  low-pass 40 Hz
  from    measured
  value   maximum
  limit   each 0.65

quantity axle_lateral "Lateral force of an axle"
  of      SigmaY
  filter  low-pass 40 Hz, then sliding mean 2 m every 0.5 m
  from    measured
  value   peak
  limit   each 15 kN + 2 * Q0 / 3

verdict
  validated  when safety holds and ride holds

verdict safety "Running safety"
  of     derailment, unloading, axle_lateral
  holds  when every limit holds

verdict ride "Ride quality"
  of     Wz_lateral, Wz_vertical
  holds  when every limit holds
  words  excellent, not excellent
