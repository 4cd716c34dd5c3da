protocol en14363-instability "Instability: sliding rms of SigmaY, by classes of equivalent conicity"
  extends  "base.fp"

section conicity "Equivalent conicity of the section"
  in  -

section class "Class of conicity"
  one of  low, medium, high
  is      low when conicity < 0.1, medium when conicity < 0.25, otherwise high

define SigmaY_lim "Limit of the sum of guiding forces"
  is  (0.85 when category is freight, otherwise 1) * (10 kN + 2/3 * Q0)

quantity {who}_instability "Sliding rms of SigmaY over 100 m, {who}"
  for each  who in measured, simulated
  of        SigmaY
  filter    band-pass 3 Hz to 7 Hz, then sliding rms 100 m every 10 m, short-sections
  from      {who}
  value     maximum
  limit     maximum SigmaY_lim / 2 for each class
  report    maximum for each class and wheelset
  where     speed >= 60 km/h

quantity difference "Difference of the rms values"
  of          SigmaY
  filter      band-pass 3 Hz to 7 Hz, then sliding rms 100 m every 10 m, short-sections
  value       maximum
  difference  (simulated - measured) / (SigmaY_lim / 2)
  limit       p95 10 % for each class
