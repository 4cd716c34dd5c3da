# The flexibility coefficient of a stationary test, in which the vehicle is slowly canted to both sides.

protocol en14067-6-flexibility "Flexibility coefficient of a stationary sway test, EN 14067-6 and EN 15273-2 kind"
  uses     plausibility-signals
  edition  "Similar to EN 14067-6:2010 and EN 15273-2:2013"
  source   "Goetz & Polach, section 3.3: the flexibility coefficient (suspension coefficient) of the"
           "kinematic gauge"
  author   "Fishplate"
  scope    "Models used for cross wind or gauging. The flexibility coefficient is the roll angle of the car"
           "body against the track over the angle of the cant, as the slope of the regression line over the"
           "whole loop."
  axis     time in s

parameter contact_spacing "Distance of the contact points, over which the cant is measured"
  default  1500 mm
  range    1000 mm to 2000 mm

parameter flexibility_difference "Limit of the relative difference of the simulated and the measured coefficient"
  default      10 %
  range        0.1 % to 100 %
  unconfirmed  "A choice of this text."
  source       "This protocol's own: the paper names the coefficient and no limit"

parameter flexibility_limit "Limit of the measured flexibility coefficient"
  default      0.4
  range        0.01 to 1
  unconfirmed  "From memory; the standard was not to hand."
  source       "EN 15273 kind, reference vehicles of the kinematic gauge"

channel cant "Cant of the vehicle"
  in  mm

channel primary_roll "Roll angle of the primary suspension"
  in      mrad
  column  "primary roll angle"

channel secondary_roll "Roll angle of the secondary suspension"
  in      mrad
  column  "secondary roll angle"

signal cant_angle "Angle of the cant"
  is  asin(cant / contact_spacing)
  in  mrad

signal body_roll "Roll angle of the car body against the track"
  is  primary_roll + secondary_roll
  in  mrad

plausibility copies
  distinct  channels, sides
  note      "A stationary test is repeated, and each loop may be compared with the same simulation."

sections
  use      whole records
  minimum  1

quantity flexibility "Flexibility coefficient, simulated against measured"
  symbol      "s"
  of          body_roll
  value       slope over cant_angle
  difference  (simulated - measured) / measured
  limit       each flexibility_difference
  in          %

quantity flexibility_measured "Flexibility coefficient of the measured vehicle"
  symbol  "s_measured"
  of      body_roll
  from    measured
  value   slope over cant_angle
  limit   each flexibility_limit
  in      -

verdict flexibility_model "Model of the flexibility coefficient"
  of     flexibility
  holds  when every limit holds
  words  validated, not validated

verdict flexibility_vehicle "Flexibility coefficient of the vehicle"
  of     flexibility_measured
  holds  when every limit holds
  words  met, not met
