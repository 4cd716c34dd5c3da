protocol en14363-on-track-assessment-multiple-regression "On-track assessment, multiple regression"
  extends  en14363-on-track-assessment
  author   "Fishplate"
  scope    "As the parent, with one regression over speed, cant deficiency and curvature for the values of"
           "zones 2, 3 and 4 together, read at the conditions of each zone. Zone 1 keeps the one-dimensional"
           "method."
  note     "Other regressors, such as the track quality, are added to the three estimates if the table of"
           "sections has them. Regressors are not selected by significance."

remove
  limit  every safety
  limit  every loading
  limit  every quasi_static

parameter admissible_cant_deficiency "Admissible cant deficiency of the vehicle"
  default  130 mm
  range    0 mm to 350 mm
  note     "A property of the vehicle: set it to that of the vehicle tested."

parameter target_factor "Cant deficiency for which maxima are estimated, over the admissible one"
  default      1.1
  range        0.5 to 1.5
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7, two-dimensional method"

define curving "Curvature of the section, 0 on straight track"
  is  0 1/m when direction is straight, otherwise 1 / radius

define in_zone_{zone_name} "1 in zone {zone_name}"
  for each  zone_name in 2, 3, 4
  is        1 when zone is {zone_name}, otherwise 0

define speed_in_zone_{zone_name} "Mean speed of the sections of zone {zone_name}"
  for each  zone_name in 2, 3, 4
  is        total of (in_zone_{zone_name} * speed) / total of in_zone_{zone_name}

define curving_in_zone_{zone_name} "Mean curvature of the sections of zone {zone_name}"
  for each  zone_name in 2, 3, 4
  is        total of (in_zone_{zone_name} * curving) / total of in_zone_{zone_name}

define radius_in_zone_4 "Mean radius of the sections of zone 4"
  is  total of (in_zone_4 * radius) / total of in_zone_4

quantity {name}
  for each  name, class, place in (SigmaY_max, safety, wheelset), (YQ_max, safety, wheelset),
            (SigmaY_instability, safety, wheelset), (ayb_rms, safety, running_gear),
            (Q_max, loading, wheelset), (ay_max, loading, running_gear), (az_max, loading, running_gear),
            (ay_rms, loading, running_gear), (az_rms, loading, running_gear)
  limit     {class} at most {name}_limit for zone 1 and each {place}
  limit     {class}_zone_2 at most {name}_limit for zones 2, 3, 4 and each {place}
  limit     {class}_zone_3 at most {name}_limit for zones 2, 3, 4 and each {place}
  limit     {class}_zone_4 at most {name}_limit for zones 2, 3, 4 and each {place}

quantity Y_qst
  limit  quasi_static_zone_2 Y_qst_limit_flat for zones 2, 3, 4 and each wheelset
  limit  quasi_static_zone_3 Y_qst_limit_flat for zones 2, 3, 4 and each wheelset
  limit  quasi_static_zone_4 Y_qst_base + Y_qst_radius / radius_in_zone_4 for zones 2, 3, 4 and each wheelset

quantity {quasi_static}
  for each  quasi_static, place, bound in (Q_qst, wheelset, Q_qst_limit), (B_qst, wheelset, B_qst_limit),
            (ay_qst, running_gear, ay_qst_limit)
  limit     quasi_static_zone_2 {bound} for zones 2, 3, 4 and each {place}
  limit     quasi_static_zone_3 {bound} for zones 2, 3, 4 and each {place}
  limit     quasi_static_zone_4 {bound} for zones 2, 3, 4 and each {place}

estimate safety_zone_{zone_name} "Estimated maximum in zone {zone_name}"
  for each     zone_name in 2, 3, 4
  is           prediction over speed, cant_deficiency, curving at speed_in_zone_{zone_name},
               target_factor * admissible_cant_deficiency, curving_in_zone_{zone_name}, confidence 99 %
  unconfirmed  "Target and confidence from memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7, multiple regression (from the DynoTRAIN project)"

estimate loading_zone_{zone_name} "Estimated maximum in zone {zone_name}"
  for each     zone_name in 2, 3, 4
  is           prediction over speed, cant_deficiency, curving at speed_in_zone_{zone_name},
               target_factor * admissible_cant_deficiency, curving_in_zone_{zone_name}, confidence 95 %
  unconfirmed  "Target and confidence from memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7, multiple regression (from the DynoTRAIN project)"

estimate quasi_static_zone_{zone_name} "Value of the regression in zone {zone_name}"
  for each     zone_name in 2, 3, 4
  is           regression over speed, cant_deficiency, curving at speed_in_zone_{zone_name},
               target_factor * admissible_cant_deficiency, curving_in_zone_{zone_name}
  unconfirmed  "Target and confidence from memory; the standard was not to hand."
  source       "EN 14363:2016, clause 7, multiple regression (from the DynoTRAIN project)"
