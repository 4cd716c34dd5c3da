protocol spectra "Spectra as signals over frequency"
  axis  distance in m
  time  time in s

parameter segment "Length of a segment"
  default  4 s

channel ay "Lateral acceleration"
  in      m/s^2
  column  "ay_I"

channel az "Vertical acceleration"
  in      m/s^2
  column  "az_I"

signal density "A spectrum with a name"
  is  spectrum(ay - az, 2 * segment, 75 %, 0.5 Hz, 20 Hz)
  in  m^2/s^3

define mask "No rule needs a spectrum to name the frequency"
  is  table frequency: (1 Hz, 0.2 m^2/s^3), (10 Hz, 0.002 m^2/s^3), held

define unused "Also where no rule uses it"
  is  1 when frequency > 2 Hz, otherwise 0.5

quantity largest "Numbers of it, each in its own unit"
  of     ay
  from   measured
  value  larger of maximum of density, (mean of (density when frequency < 3 Hz))
  limit  each 1 m^2/s^3
  in     m^2/s^3

quantity bandwidth "The widest band above a share of its mean"
  of     ay
  from   measured
  value  longest run where density > 0.3 * mean of density
  limit  each 3 Hz
  in     Hz

quantity margin "Below a mask, in dB"
  of     ay
  from   measured
  value  minimum of (10 * log10(mask / spectrum(ay through low-pass 30 Hz, segment)))
  limit  each at least 0

quantity ratio "Both sides, line by line"
  of      ay
  metric  maximum of |10 * log10(spectrum(simulated, 4 s) / spectrum(measured, 4 s))|
  limit   each 6

verdict
  validated  when every limit holds
