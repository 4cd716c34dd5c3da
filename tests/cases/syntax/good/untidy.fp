#no blank after the hash
verdict
      validated   when   every   # beside the first line
          # between the lines
          limit  holds           # beside the last
zone 2
#### banner
protocol    tidy-me   "A  title" # beside
 note "one"
      "two"    # parts
 extends "../a  b.fp"
 axis
    distance
    in m
 # below the fields
# before the zone
zone 1
  minimum    sections 3
  where a   and "x  #  y"
# last words
