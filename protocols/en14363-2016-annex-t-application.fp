# Annex T with one addition: the operation that the model is wanted for is compared with what the sections cover.

protocol en14363-2016-annex-t-application "EN 14363:2016 Annex T with validation domain and application domain"
  extends  en14363-2016-annex-t
  author   "Fishplate, as an example of a proposal"
  scope    "As Annex T; in addition, the report states which wanted speeds, cant deficiencies and curvatures"
           "lie inside what the sections cover, and how far outside the others are."

define section_curvature "Curvature of a section, 0 on straight track"
  is  0 1/m when direction is straight, otherwise 1 / radius

domain application "Application domain"
  over       speed, cant_deficiency, section_curvature in 1/km
  otherwise  note
  source     "The method is this protocol's own; Annex T does not say how the domain of a validated model is"
             "bounded"
  note       "A point inside the hull lies between sections that were compared. That the model is valid there"
             "is still a judgement. A variant can let a point outside decide, with the field otherwise."
