protocol domains "Domains that cannot be"
  axis  distance in m

section speed "Speed"
  in  km/h

section direction "Direction"
  one of  right, left

vehicle mass "Mass"
  in  kg

channel F "Force"
  in  kN

quantity F_mean
  of          F
  value       mean
  difference  signed
  limit       std 1 kN

domain nothing "Nothing spans it"
  otherwise  note

domain unknown "Names that are none"
  over  sped, speed for each directon

domain words "A word, a number in place of a word"
  over  direction for each speed

domain units "Units that are none or of something else"
  over  speed in kn, 1 / speed in km/h

domain same "The same for every section, and where a section lies"
  over  vehicle.mass, length

domain syntax "Not what a domain is over"
  over  speed, for each direction

domain otherwise "A treatment of sections"
  over       speed
  otherwise  not used
