protocol en14363-on-track-assessment-two-dimensional "On-track assessment, two-dimensional method"
  extends  en14363-on-track-assessment
  author   "Fishplate"
  scope    "As the parent, with the regression of the values over the cant deficiency in the curve zones. In"
           "zone 1 the cant deficiency does not vary: the one-dimensional method holds there."

parameter admissible_cant_deficiency "Admissible cant deficiency of the vehicle"
  default  130 mm
  range    0 mm to 350 mm
  note     "A property of the vehicle: set it to that of the vehicle tested."

parameter target_factor "Cant deficiency for which maxima are estimated, over the admissible one"
  default      1.1
  range        0.5 to 1.5
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7, two-dimensional method"

estimate safety "Estimated maximum"
  is           mean + k_safety * std when zone is 1,
               otherwise prediction over cant_deficiency at target_factor * admissible_cant_deficiency,
               confidence 99 %
  unconfirmed  "Target and confidence from memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7, two-dimensional method"
  note         "The interval is two-sided: 0.5 % lie above."

estimate loading "Estimated maximum"
  is           mean + k_loading * std when zone is 1,
               otherwise prediction over cant_deficiency at target_factor * admissible_cant_deficiency,
               confidence 95 %
  unconfirmed  "Target and confidence from memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7, two-dimensional method"
  note         "The interval is two-sided: 2.5 % lie above."

estimate quasi_static "Value of the regression line"
  is      regression over cant_deficiency at target_factor * admissible_cant_deficiency
  source  "EN 14363:2016, clause 7, two-dimensional method"
