# Every metric of the registry that rates a pair of signals, on the signals of the 12 quantities of EN 14363 Annex T.

protocol metrics-side-by-side "Metrics of time histories and distributions side by side"
  uses    plausibility-signals
  source  "Goetz & Polach, Table 2, and the publications named with each metric"
  author  "Fishplate"
  scope   "What each metric says of the same signals, section by section. No metric is a requirement of a"
          "standard; each has a verdict of its own, by limits that are choices of this text."
  axis    distance in m
  time    time in s
  note    "The measurement is the reference. The mean is not removed. CORA is unverified: its numbers are not"
          "checked against a reference implementation."

parameter {metric}_limit "Limit of the mean over sections and signals, {words}"
  for each     metric, words, value, allowed in (sprague_geers, "Sprague & Geers", 0.4, 0 to 10),
               (russell, "Russell", 0.28, 0 to 10), (theil, "Theil", 0.3, 0 to 1),
               (misfit, "Misfit", 0.25, 0 to 100),
               (nrmse, "Normalised root mean square difference", 0.5, 0 to 100),
               (correlation, "Correlation", 0.7, -1 to 1), (match, "Matching probability", 0.5, 0 to 1),
               (wifac, "Weighted integrated factor", 0.5, 0 to 1), (iso18571, "ISO/TS 18571", 0.58, 0 to 1),
               (cora, "CORA (unverified)", 0.58, 0 to 1)
  default      {value}
  range        {allowed}
  unconfirmed  "A choice of this text, so that metrics can be compared by what they accept."

place wheelset
  members  1, 2, 3, 4

place side
  members  R, L

place running_gear
  members  I, II

channel Y "Guiding force"
  in      kN
  at      each wheelset and side
  column  "Y_{wheelset}{side}"

channel Q "Vertical wheel force"
  in      kN
  at      each wheelset and side
  column  "Q_{wheelset}{side}"

channel ay "Car body lateral acceleration"
  in      m/s^2
  at      each running_gear
  column  "ay_{running_gear}"

channel az "Car body vertical acceleration"
  in      m/s^2
  at      each running_gear
  column  "az_{running_gear}"

signal YQ "Ratio Y/Q"
  is     Y / Q
  at     each wheelset and side
  in     -
  named  "YQ_{wheelset}{side}"
  note   "Calculated sample by sample, then filtered."

signal SigmaY "Sum of guiding forces"
  is     Y at side R + Y at side L
  at     each wheelset
  in     kN
  named  "SigmaY_{wheelset}"

filter LP20 "Low-pass filter 20 Hz"
  step  low-pass 20 Hz, order 4, zero-phase, as-applied

quantity {signal}_{metric} "{title}, {words}"
  for each  metric, wording, bound,
            words in (sprague_geers, "sprague-geers comprehensive", sprague_geers_limit, "Sprague & Geers"),
            (russell, "russell comprehensive", russell_limit, "Russell"),
            (theil, "theil inequality", theil_limit, "Theil"), (misfit, "misfit", misfit_limit, "Misfit"),
            (nrmse, "normalised root-mean-square difference", nrmse_limit,
            "Normalised root mean square difference"),
            (correlation, "correlation", at least correlation_limit, "Correlation"),
            (match, "matching probability, 50 points", at least match_limit, "Matching probability"),
            (wifac, "weighted integrated factor", at least wifac_limit, "Weighted integrated factor"),
            (iso18571, "iso18571 overall", at least iso18571_limit, "ISO/TS 18571"),
            (cora, "cora total", at least cora_limit, "CORA (unverified)")
  for each  signal, title, positions in (Y, Guiding force, "wheelsets 1, 3"),
            (Q, Vertical wheel force, "wheelsets 1, 3"), (YQ, Ratio Y/Q, "wheelsets 1, 3"),
            (SigmaY, Sum of guiding forces, "wheelsets 1, 3"),
            (ay, Car body lateral acceleration, "running gears I, II"),
            (az, Car body vertical acceleration, "running gears I, II")
  of        {signal} at {positions}
  filter    LP20
  metric    {wording}
  limit     mean {bound}

quantity {signal}_{part} "{title}, {wording}"
  for each  part, wording in (sprague_geers_magnitude, sprague-geers magnitude),
            (sprague_geers_phase, sprague-geers phase), (russell_magnitude, russell magnitude),
            (theil_bias, theil bias), (theil_variance, theil variance), (theil_covariance, theil covariance),
            (nrmse_range, range-normalised root-mean-square difference), (rmse, root-mean-square difference),
            (area, area between distributions), (iso18571_corridor, iso18571 corridor),
            (iso18571_phase, iso18571 phase), (iso18571_magnitude, iso18571 magnitude),
            (iso18571_slope, iso18571 slope), (cora_corridor, cora corridor),
            (cora_progression, cora progression), (cora_size, cora size), (cora_phase, cora phase)
  for each  signal, title, positions in (Y, Guiding force, "wheelsets 1, 3"),
            (Q, Vertical wheel force, "wheelsets 1, 3"), (YQ, Ratio Y/Q, "wheelsets 1, 3"),
            (SigmaY, Sum of guiding forces, "wheelsets 1, 3"),
            (ay, Car body lateral acceleration, "running gears I, II"),
            (az, Car body vertical acceleration, "running gears I, II")
  of        {signal} at {positions}
  filter    LP20
  metric    {wording}
  reported  "Part of a metric, or without a limit that could be compared."

quantity {signal}_rms_{name} "{title}, ratio of the rms values from {low} to {high}"
  for each  name, low, high in (05, 0.5 Hz, 1 Hz), (1, 1 Hz, 2 Hz), (2, 2 Hz, 4 Hz), (4, 4 Hz, 8 Hz),
            (8, 8 Hz, 16 Hz)
  for each  signal, title, positions in (Y, Guiding force, "wheelsets 1, 3"),
            (Q, Vertical wheel force, "wheelsets 1, 3"), (YQ, Ratio Y/Q, "wheelsets 1, 3"),
            (SigmaY, Sum of guiding forces, "wheelsets 1, 3"),
            (ay, Car body lateral acceleration, "running gears I, II"),
            (az, Car body vertical acceleration, "running gears I, II")
  of        {signal} at {positions}
  filter    LP20, then band-pass {low} to {high}, order 4, zero-phase, as-applied
  metric    root-mean-square ratio
  reported  "By octave."

quantity {signal}_coherence_{name} "{title}, coherence from {low} to {high}"
  for each  name, low, high in (05, 0.5 Hz, 1 Hz), (1, 1 Hz, 2 Hz), (2, 2 Hz, 4 Hz), (4, 4 Hz, 8 Hz),
            (8, 8 Hz, 16 Hz)
  for each  signal, title, positions in (Y, Guiding force, "wheelsets 1, 3"),
            (Q, Vertical wheel force, "wheelsets 1, 3"), (YQ, Ratio Y/Q, "wheelsets 1, 3"),
            (SigmaY, Sum of guiding forces, "wheelsets 1, 3"),
            (ay, Car body lateral acceleration, "running gears I, II"),
            (az, Car body vertical acceleration, "running gears I, II")
  of        {signal} at {positions}
  filter    LP20
  metric    coherence from {low} to {high}
  reported  "By octave."

verdict every_metric "Agreement by every metric"
  holds  when by_sprague_geers holds and by_russell holds and by_theil holds and by_misfit holds
         and by_nrmse holds and by_correlation holds and by_match holds and by_wifac holds
         and by_iso18571 holds and by_cora holds
  words  agrees, does not agree

verdict by_{metric} "Agreement by {words}"
  for each  metric, words in (sprague_geers, "Sprague & Geers"), (russell, "Russell"), (theil, "Theil"),
            (misfit, "Misfit"), (nrmse, "Normalised root mean square difference"),
            (correlation, "Correlation"), (match, "Matching probability"),
            (wifac, "Weighted integrated factor"), (iso18571, "ISO/TS 18571"), (cora, "CORA (unverified)")
  of        Y_{metric}, Q_{metric}, YQ_{metric}, SigmaY_{metric}, ay_{metric}, az_{metric}
  holds     when every limit holds
  words     agrees, does not agree
