protocol en14363-next-edition "Validation after Annex T with test zone 5 and other counts"
  extends  en14363-2016-annex-t
  edition  "EN 14363:2016, Annex T, with changes as discussed for the next edition"
  author   "Fishplate, as an example of a proposal"
  scope    "Curves below 250 m radius are a zone of their own, and zone 4 needs a fourth section. CEN/TS"
           "17843:2022 introduces a test zone 5; its text was not to hand."

parameter sections_in_zone_5 "Sections required in test zone 5"
  default  0
  range    0 to 100
  source   "Proposal"
  note     "0: sections of zone 5 are evaluated where the test has some, and none is required."

zone 5 "Extremely small radius curves"
  where             150 m <= radius < 250 m
  minimum sections  sections_in_zone_5
  minimum length    50 m
  source            "Radius below 250 m: public summary of CEN/TS 17843:2022. Lower radius and length:"
                    "proposal"

zone 4
  minimum sections  4
  source            "Proposal; Annex T requires 3"

verdict
  minimum pairs  26
