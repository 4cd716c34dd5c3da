protocol en14363-2016-annex-t-six-sections "EN 14363:2016 Annex T with six sections per test zone"
  extends  en14363-2016-annex-t
  author   "Fishplate, as an example of a proposal"
  scope    "Twice the number of sections of Annex T in each test zone, so that the verdict depends less on"
           "their selection."

parameter sections_per_zone
  default  6
  source   "Proposal; Annex T requires 3"

verdict
  minimum pairs  48
