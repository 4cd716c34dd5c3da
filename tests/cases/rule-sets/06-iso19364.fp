protocol iso19364-style "Tolerance corridors about the measurement, ISO 19364 / 19365 style"
  extends  "base.fp"

parameter gain_tolerance "Share of the measured value"
  default  15 %

parameter offset_tolerance "Offset"
  default  3 kN

signal Yf "Filtered guiding force"
  is  Y through low-pass 6 Hz
  at  each wheelset and side

define half_width "Half the width of the corridor at a sample"
  is  offset_tolerance + gain_tolerance * |measured|

define off_by "Distance from the measurement at the same sample, the simulation moved"
  of  distance_moved
  is  |shifted(simulated, distance_moved) - measured|

quantity outside "Share of samples outside the corridor"
  of      Y at wheelsets 1, 3
  filter  low-pass 6 Hz
  metric  share where |simulated - measured| > half_width
  limit   each 80 %

quantity outside_x "The same, of a corridor that is 0.5 m wide on either side along the track"
  of      Y at wheelsets 1, 3
  filter  low-pass 6 Hz
  metric  share where off_by(-0.5 m) > half_width and off_by(0 m) > half_width and off_by(0.5 m) > half_width
  limit   each 80 %

quantity peak_value "First peak"
  of          Yf at wheelsets 1, 3
  value       maximum
  difference  signed
  limit       each 15 kN

quantity peak_time "Time of the peak, from the start of the section"
  of          Yf at wheelsets 1, 3
  value       minimum of (clock when Yf >= maximum of Yf) - minimum of clock
  difference  signed
  limit       p80 2 s

verdict
  validated  when corridor holds and peaks holds

verdict corridor "Corridors"
  of     outside, outside_x
  holds  when every limit holds
  words  within tolerance, outside tolerance

verdict peaks "Peaks"
  of     peak_value, peak_time
  holds  when every limit holds
