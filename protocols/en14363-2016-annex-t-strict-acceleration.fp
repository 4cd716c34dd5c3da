protocol en14363-2016-annex-t-strict-acceleration "EN 14363:2016 Annex T with stricter limits of car body acceleration"
  extends  en14363-2016-annex-t
  author   "Fishplate, as an example of a proposal"
  scope    "For models used to assess ride comfort: acceleration limits at 70 % of those of Annex T, and no"
           "doubling for freight vehicles."

quantity ay_rms
  limit   std 0.105 m/s^2
  source  "Proposal; Table 1 has 0.15 m/s^2"

quantity az_rms
  limit   std 0.105 m/s^2
  source  "Proposal; Table 1 has 0.15 m/s^2"

quantity ay_max
  limit   std 0.28 m/s^2
  source  "Proposal; Table 1 has 0.40 m/s^2"

quantity az_max
  limit   std 0.28 m/s^2
  source  "Proposal; Table 1 has 0.40 m/s^2"
