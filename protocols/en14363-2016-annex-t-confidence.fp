protocol en14363-2016-annex-t-confidence "EN 14363:2016 Annex T with 95 % confidence"
  extends  en14363-2016-annex-t
  author   "Fishplate, as an example of a proposal"
  scope    "A proposal: the limits of Annex T hold with 95 % confidence, not only for the sections tested."
           "The bounds come from a bootstrap that draws whole sites, so that repeats of a section do not"
           "count as further tests."
  note     "With the twelve sites of Annex T the bounds are too small: in trials, 95 % bounds by bootstrap"
           "held in 76 to 90 % of the cases."

quantity {name}
  for each  name in Y_qst, Q_qst, YQ_qst, SigmaY_qst, Y_max, Q_max, YQ_max, SigmaY_max, ay_rms, az_rms,
            ay_max, az_max
  limit     (upper 95 % of std by bootstrap) limit of std
  limit     (upper 95 % of mean by bootstrap) limit of mean
  limit     (lower 95 % of mean by bootstrap) limit of mean
