protocol spectra "Numbers of spectra"
  axis  distance in m
  time  time in s

channel ay "Lateral acceleration of the car body"
  in      m/s^2
  column  "ay_I"

signal density "A spectrum by its name"
  is  spectrum(ay, 2 s, 1 Hz, 40 Hz)
  in  m^2/s^3

define mask "A limit over the frequency"
  is  table frequency: (0 Hz, 0.2 m^2/s^3), (2 Hz, 0.05 m^2/s^3), (10 Hz, 0.002 m^2/s^3), held

quantity largest "The largest line"
  of     ay
  from   measured
  value  maximum of density
  limit  each 1 m^2/s^3
  in     m^2/s^3

quantity band "Mean of a band, half-open"
  of     ay
  from   measured
  value  mean of (spectrum(ay, 1.5 s, 75 %) when 2 Hz < frequency <= 8 Hz)
  limit  each 1 m^2/s^3
  in     m^2/s^3

quantity margin "Distance below the mask, dB"
  of     ay
  from   measured
  value  minimum of (10 * log10(mask / spectrum(ay, 2 s)))
  limit  each at least 0

quantity wide "The widest band of high content"
  of     ay
  from   measured
  value  longest run where density > 0.3 * mean of density
  limit  each 20 Hz
  in     Hz

quantity level "Largest difference of the levels, dB"
  of      ay
  metric  maximum of |10 * log10(spectrum(simulated, 2 s, 1 Hz, 10 Hz) / spectrum(measured, 2 s, 1 Hz, 10 Hz))|
  limit   each 6

quantity within "Share of the lines within a factor of two above 3.2 Hz"
  of      ay
  metric  share where 0.5 <= spectrum(simulated, 2 s) / spectrum(measured, 2 s) <= 2 and frequency > 3.2 Hz
  limit   each at least 50 %

verdict
  validated  when every limit holds
