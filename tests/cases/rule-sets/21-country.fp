protocol country-strata "Strata by country and track_line, and a pooled verdict"
  extends  "base.fp"

section country "Country"
  one of  any word

section track_line "Line"
  one of  any word
  column  "line"

sections
  report  share of sections where country is IT
  report  total of length for each country and track_line

quantity {ch}_qst "Quasi-static {ch}"
  for each       ch, s in (Y, 2 kN), (Q, 2 kN)
  of             {ch} at wheelsets 1, 3
  filter         LP20
  value          median
  difference     signed
  limit          std {s} for each country and track_line
  limit          (mean of (mean for each country)) 1 kN
  limit          std 1.5 * {s}
  report         n for each country
  minimum pairs  4 for each country and track_line
