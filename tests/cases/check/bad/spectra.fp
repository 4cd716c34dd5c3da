protocol spectra "What is no spectrum"
  axis  distance in m
  time  time in s

channel ay "Lateral acceleration"
  in      m/s^2
  column  "ay_I"

channel cant "Cant"
  in      mm
  column  "cant"
  record  track

signal density "A spectrum"
  is  spectrum(ay, 4 s)

signal filtered "A spectrum has no filter"
  is  density through low-pass 10 Hz

signal steep "And no slope along the record"
  is  derivative(density)

signal twice "And no spectrum"
  is  spectrum(density, 4 s)

signal mixed "Its lines are no samples"
  is  density / spectrum(ay, 4 s) * ay

signal number "A number has none"
  is  spectrum(1, 4 s)

signal of_track "The track has no time"
  is  spectrum(cant, 4 s)

signal by_length "A segment is a time"
  is  spectrum(ay, 4 m)

signal whole "Segments move on"
  is  spectrum(ay, 4 s, 100 %)

signal band "A band begins before it ends"
  is  spectrum(ay, 4 s, 10 Hz, 1 Hz)

signal bare "Without a segment"
  is  spectrum(ay)

quantity own "A quantity is of a signal along the record"
  of          density
  value       maximum
  difference  signed
  limit       std 1 m^2/s^3

quantity alone "No spectrum, no frequency"
  of          ay
  value       maximum of (ay when frequency > 2 Hz)
  difference  signed
  limit       std 1 m/s^2

quantity lone "Nor by itself"
  of          ay
  value       maximum of frequency
  difference  signed
  limit       std 1 Hz

quantity in_time "Lines follow no time"
  of          ay
  value       longest run in time where density > 0.1 m^2/s^3
  difference  signed
  limit       std 1 s

quantity windowed "Nor has it windows"
  of          ay
  value       maximum of (density through sliding mean 1 s every 0.5 s)
  difference  signed
  limit       std 1 m^2/s^3

verdict
  validated  when every limit holds
