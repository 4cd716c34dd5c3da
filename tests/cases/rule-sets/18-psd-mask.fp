protocol psd-mask "Spectra: simulated within 3 dB of measured, and measured below a mask"
  extends  "base.fp"

parameter segment "Length of a segment"
  default  4 s

define mask "Largest power spectral density of the body accelerations"
  is  table frequency: (1 Hz, 0.2 m^2/s^3), (2 Hz, 0.05 m^2/s^3), (10 Hz, 0.002 m^2/s^3)

define level "The simulated spectrum over the measured one, dB"
  is  10 * log10(spectrum(simulated, segment, 1 Hz, 10 Hz) / spectrum(measured, segment, 1 Hz, 10 Hz))

quantity {ch}_level "{ch}: largest difference of the levels from 1 to 10 Hz, dB"
  for each  ch in ay, az
  of        {ch}
  metric    maximum of |level|
  limit     median 6
  limit     p90 12

quantity {ch}_within "{ch}: share of the lines from 1 to 10 Hz within 3 dB"
  for each  ch in ay, az
  of        {ch}
  metric    share where |level| <= 3
  limit     each at least 90 %

quantity {ch}_margin "{ch}: smallest distance below the mask from 1 to 10 Hz, dB"
  for each  ch in ay, az
  of        {ch}
  from      measured
  value     minimum of (10 * log10(mask / spectrum({ch}, segment, 75 %, 1 Hz, 10 Hz)))
  limit     each at least 0
