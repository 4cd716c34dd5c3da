protocol like "Quantities like others, estimates by zone, short sections"
  extends  en14363-2016-annex-t

remove
  quantity  every

estimate largest_{level} "Estimate, {level}"
  for each     level, share in (high, 95 %), (low, 50 %)
  is           mean + 3 * std when zone is 1,
               otherwise prediction over cant_deficiency at 143 mm, confidence {share}
  unconfirmed  "The confidence is an example."

quantity SigmaY "Sum of guiding forces, measured"
  from    measured
  of      SigmaY at wheelsets 1, 3
  filter  LP20, then sliding rms 100 m every 10 m, short-sections
  value   maximum
  limit   largest_high 50 kN for each zone and wheelset
  limit   largest_low 50 kN for each zone and wheelset

quantity {name}_simulated "Sum of guiding forces, simulated"
  for each  name in SigmaY, SigmaY_median
  like      {name}
  from      simulated

quantity SigmaY_median "Sum of guiding forces, median"
  like   SigmaY
  value  median
  limit  largest_low 40 kN for each zone and wheelset

quantity SigmaY_difference "Sum of guiding forces, simulated less measured"
  like        SigmaY
  difference  signed
