# Rules in our own words; the text of the standard is not reproduced. Numbers: Table 1 of the paper named under `source`.

protocol en14363-2016-annex-t "Validation of a simulation model by on-track tests, EN 14363:2016 Annex T"
  uses     plausibility-signals
  edition  "EN 14363:2016, Annex T (method of the DynoTRAIN project)"
  source   "Goetz & Polach, Verification and validation of simulations in a rail vehicle certification"
           "context, Table 1"
  author   "Fishplate"
  scope    "Simulation models of rail vehicles for the acceptance of running characteristics: differences"
           "between simulation and measurement over at least three sections in each of the four test zones."
  axis     distance in m
  time     time in s

parameter lowpass_frequency "Cut-off of the low-pass filter"
  default  20 Hz
  range    5 Hz to 60 Hz
  source   "Table 1"

parameter lowpass_order "Order of the low-pass filter, one pass"
  default  4
  range    1 to 10

parameter bandpass_order "Order of the band-pass filter at each edge, one pass"
  default  4
  range    1 to 10

parameter filter_phase "Filtering forward and backward, or causal"
  default  zero-phase
  one of   zero-phase, causal, causal-from-rest
  note     "The table does not specify it; zero phase preserves the position of a peak."

parameter filter_edge "Whether the -3 dB points are those of the filter as applied or of each pass"
  default  as-applied
  one of   as-applied, per-pass

parameter window_ends "Sliding mean as the mean of the samples in the window, or as the integral over it"
  default  samples
  one of   samples, integral

parameter sliding_input "Input signal of the sliding mean"
  default  unfiltered
  one of   unfiltered, lowpassed
  note     "Table 1 specifies no other filter; common practice applies a 20 Hz low-pass before."

parameter ratio_from "Y/Q calculated from the recorded or from the filtered Y and Q"
  default  unfiltered
  one of   unfiltered, lowpassed

parameter percentile_rule "Interpolation of a percentile between two samples (Hyndman & Fan)"
  default  linear
  one of   linear, hazen, weibull, median_unbiased, normal_unbiased, inverted_cdf, nearest, lower, higher

parameter quasi_static_difference "Sign of the difference of quasi-static values"
  default  oriented
  one of   oriented, signed, magnitudes
  note     "Oriented: positive if the simulated value is larger in the direction of the measured value, in"
           "right and left curves. A wrong sign then gives a large difference; magnitudes would hide it."

parameter maximum_side "Side of the distribution from which a maximum is taken"
  default  own
  one of   own, measurement, curve
  note     "Own: the side with the larger magnitude, separately for simulation and measurement. Measurement:"
           "the side that is larger in the measurement, for both. Curve: 0.15 % in right-hand and 99.85 % in"
           "left-hand curves for the sum of guiding forces, the opposite for the lateral acceleration; for a"
           "single wheel the side of its measured quasi-static value; on straight track and for the vertical"
           "acceleration as own."

parameter variance_divisor "Divisor of the variance"
  default  n-1
  one of   n-1, n

parameter mean_limit_share "Limit of the mean as a share of the limit of the standard deviation"
  default  2/3
  range    0.01 to 10
  source   "Section 3.2"

parameter sections_per_zone "Sections required in each test zone"
  default  3
  range    1 to 100
  source   "Section 3.2"

parameter evaluated_wheelsets "Wheelsets whose forces are compared"
  default  1, 3
  at       wheelset
  source   "Section 3.2: at least two signals of each quantity"
  note     "1 and 3 are the leading wheelsets of the bogies, with the largest guiding forces; this is the"
           "protocol's own choice. The paper also mentions trailing wheelsets (2 and 4), and in practice both"
           "wheelsets of one bogie are often instrumented. Set it to the measured wheelsets."

place wheelset
  members  1, 2, 3, 4

place side
  members  R, L
  alias    outer is L when direction is right, R when direction is left
  alias    inner is R when direction is right, L when direction is left

place running_gear
  members  I, II

vehicle category "Vehicle category"
  one of  passenger, locomotive, freight

vehicle running_gear_type "Running gear"
  one of  bogies, single_axles
  key     running_gear

vehicle secondary_suspension "Secondary suspension"
  one of  true, false

vehicle Q0 "Static vertical wheel force"
  in     kN
  key    static_wheel_load
  range  10 kN to 200 kN
  note   "Of one wheel. The range corresponds to axle loads from 2 t to 41 t. A value outside it is likely in"
         "another unit, or the load of an axle or of the vehicle."

vehicle admissible_speed "Admissible speed, which determines the length of sections"
  in        km/h
  optional  not assessable
  note      "On-track tests are run up to 1.1 times this speed."

section zone "Test zone"
  one of  zones

section radius "Curve radius"
  in  m

section direction "Direction"
  one of  right, left, straight

section cant "Cant"
  in  mm

section cant_deficiency "Cant deficiency"
  in  mm

section speed "Speed"
  in  km/h

channel Y "Guiding force"
  in      kN
  at      each wheelset and side
  column  "Y_{wheelset}{side}"
  note    "Positive to the right of the running direction."

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

channel curvature "Curvature of the track"
  in      1/m
  record  track

channel track_cant "Cant of the track"
  in      mm
  column  "cant"
  record  track

channel running_distance "Distance along the track"
  in      m
  column  "distance"

channel clock "Time of the samples"
  in      s
  column  "time"

signal YQ "Ratio Y/Q"
  is     (Y through LP20) / (Q through LP20) when ratio_from is lowpassed, otherwise Y / Q
  at     each wheelset and side
  in     -
  named  "YQ_{wheelset}{side}"
  note   "Calculated sample by sample."

signal SigmaY "Sum of guiding forces"
  is     Y at side R + Y at side L
  at     each wheelset
  in     kN
  named  "SigmaY_{wheelset}"

signal SigmaQ "Sum of the vertical wheel forces of a wheelset"
  is     Q at side R + Q at side L
  at     each wheelset
  in     kN
  named  "SigmaQ_{wheelset}"

signal DeltaQ "Difference of left and right vertical wheel force of a wheelset"
  is     Q at side L - Q at side R
  at     each wheelset
  in     kN
  named  "DeltaQ_{wheelset}"

signal TotalY "Sum of all guiding forces"
  is     SigmaY at wheelset 1 + SigmaY at wheelset 2 + SigmaY at wheelset 3 + SigmaY at wheelset 4
  in     kN
  named  "TotalY"

signal TotalQ "Sum of all vertical wheel forces"
  is     SigmaQ at wheelset 1 + SigmaQ at wheelset 2 + SigmaQ at wheelset 3 + SigmaQ at wheelset 4
  in     kN
  named  "TotalQ"

signal SiblingsI "Difference of the vertical forces of wheelsets 1 and 2 on one side"
  is     Q at wheelset 1 - Q at wheelset 2
  at     each side
  in     kN
  named  "Q_1{side} - Q_2{side}"

signal SiblingsII "Difference of the vertical forces of wheelsets 3 and 4 on one side"
  is     Q at wheelset 3 - Q at wheelset 4
  at     each side
  in     kN
  named  "Q_3{side} - Q_4{side}"

filter LP20 "Low-pass filter 20 Hz"
  step    low-pass lowpass_frequency, order lowpass_order, filter_phase, filter_edge
  source  "Table 1"

filter RATIO "Low-pass filter 20 Hz of a ratio"
  step    LP20 when ratio_from is unfiltered
  source  "Table 1"
  note    "A ratio of filtered forces is not filtered again."

filter BP "Band-pass filter 0.4 to 10 Hz"
  step    band-pass 0.4 Hz to 10 Hz, order bandpass_order, filter_phase, filter_edge
  source  "Table 1"

filter WINDOW "Sliding mean 2 m, step 0.5 m"
  step    LP20 when sliding_input is lowpassed
  step    sliding mean 2 m every 0.5 m, window_ends
  source  "Table 1"

filter RATIO_WINDOW "Sliding mean 2 m, step 0.5 m, of a ratio"
  step    RATIO when sliding_input is lowpassed
  step    sliding mean 2 m every 0.5 m, window_ends
  source  "Table 1"

define larger_side "Larger magnitude of both ends of the distribution"
  is  larger of |p0.15|, |p99.85|

define measured_side "Magnitude of the end of the distribution that is larger in the measurement"
  is  |p99.85| when |measured(p99.85)| >= |measured(p0.15)|, otherwise |p0.15|

define extreme_value "Magnitude of the 0.15 % or 99.85 % value of a single wheel"
  is      larger_side when maximum_side is own or (maximum_side is curve and direction is straight),
          measured_side when maximum_side is measurement,
          |p99.85| when sign(measured(median)) > 0,
          otherwise |p0.15|
  source  "Table 1 and its footnote *"
  note    "In a curve, the forces of the outer and the inner wheel have opposite signs: the quasi-static"
          "value determines the side."

define extreme_sum "Magnitude of the 0.15 % or 99.85 % value of the sum of guiding forces"
  is      larger_side when maximum_side is own or (maximum_side is curve and direction is straight),
          measured_side when maximum_side is measurement,
          |p0.15| when direction is right,
          otherwise |p99.85|
  source  "Table 1 and its footnote *"
  note    "Guiding forces are positive to the right and act to the outside of a curve."

define extreme_lateral "Magnitude of the 0.15 % or 99.85 % value of the lateral acceleration"
  is      larger_side when maximum_side is own or (maximum_side is curve and direction is straight),
          measured_side when maximum_side is measurement,
          |p99.85| when direction is right,
          otherwise |p0.15|
  source  "Table 1 and its footnote *"
  note    "The lateral acceleration is positive to the right: to the inside of a right-hand curve."

define extreme_vertical "Magnitude of the 0.15 % or 99.85 % value of the vertical acceleration"
  is      measured_side when maximum_side is measurement, otherwise larger_side
  source  "Table 1 and its footnote *"
  note    "For the vertical acceleration the curve defines no side."

define lighter_requirements "Vehicles whose acceleration limits are doubled"
  is      vehicle.category is freight or vehicle.running_gear_type is single_axles
          or not vehicle.secondary_suspension
  source  "Table 1, footnote **"

define turn "1 in right-hand curves, -1 in left-hand curves"
  is  1 when direction is right, -1 when direction is left, otherwise 0

define unbalanced_acceleration "Lateral acceleration in the plane of the track, positive to the right"
  is    turn * (speed^2 / radius - 9.80665 m/s^2 * cant / 1500 mm)
  note  "1500 mm: distance of the contact points."

zone 1 "Straight track and very large radius curves"
  where             direction is straight or (radius > 600 m and |cant_deficiency| <= 40 mm)
  minimum sections  sections_per_zone
  minimum length    250 m when admissible_speed <= 220 km/h, otherwise 500 m
  unconfirmed       "Radius, 40 mm and length from memory of EN 14363; the standard was not to hand."
  source            "Zone and lengths of 70 m to 500 m in all: section 3.1"

zone 2 "Large radius curves"
  where             radius > 600 m
  minimum sections  sections_per_zone
  minimum length    100 m when admissible_speed <= 140 km/h,
                    250 m when admissible_speed <= 220 km/h,
                    otherwise 500 m
  unconfirmed       "Radius and length from memory of EN 14363; the standard was not to hand."
  source            "Zone: section 3.1"
  note              "No range of the cant deficiency is required."

zone 3 "Small radius curves"
  where             400 m <= radius <= 600 m
  minimum sections  sections_per_zone
  minimum length    100 m
  unconfirmed       "Radii and length from memory of EN 14363; the standard was not to hand."
  source            "Zone: section 3.1"

zone 4 "Very small radius curves"
  where             250 m <= radius < 400 m
  minimum sections  sections_per_zone
  minimum length    70 m
  unconfirmed       "Radii from memory of EN 14363; the standard was not to hand."
  source            "Zone and length of 70 m: section 3.1"

check full_curve "Section lies in full curve or on straight track"
  require    range of curvature <= 2 % * |mean of curvature| + 0.00001 1/m
  unchecked  note
  source     "Section 3.2"
  note       "Requires the track file; the tolerance is this protocol's own."

plausibility exchanged
  exchanged  from 0.6, by 0.3, alike from 0.7
  note       "Forces of neighbouring wheels are alike: in sound sections a channel agrees with another one"
             "better than with its own by at most 0.04. Over all channels, records of six sound campaigns"
             "have correlations of 0.62 to 0.95 with their own simulation, and of at most 0.29 with records"
             "of other sites, which have other irregularities."

plausibility copied_section "Noise that both sides share in one section"
  of         Y
  of         Q
  of         ay
  of         az
  require    shared_content(60 Hz, 100 Hz) <= 0.3
  concerns   record
  otherwise  not assessable
  cause      "one of the two records was made from the other: with noise, delayed, scaled or blended"
  note       "In 640 sound sections the share is at most 0.1."

plausibility shared_noise "Noise that simulation and measurement share"
  of         Y
  of         Q
  of         ay
  of         az
  require    shared_content(60 Hz, 100 Hz) <= 0.04
  over       sections
  concerns   record
  otherwise  not assessable
  cause      "one of the two records was made from the other: with noise, delayed, scaled or blended"
  note       "Above 60 Hz a measurement is noise, of which a simulation knows nothing. In 41 sound campaigns"
             "the share is at most 0.01; half of a copy in a blend shares nearly all."

plausibility independent "Differences as large as those of a model"
  of         Y
  of         Q
  of         ay
  of         az
  require    unexplained_content(1 Hz, 10 Hz) >= 0.2
  over       sections
  concerns   record
  otherwise  not assessable
  cause      "one of the two records was made from the other: filtered, with noise, scaled or fitted"
  note       "In 41 sound campaigns it is at least 0.38 in every channel, with 4.3 in the middle: the errors"
             "of a model are larger than the noise. Of copies with noise or behind a filter it is below 0.15."

plausibility mirrored "Records in the same direction"
  of         az
  filter     BP
  require    mirrored_correlation <= larger of 0.6, correlation + 0.3
  concerns   record
  otherwise  not used
  cause      "a record in the opposite running direction"

plausibility aligned "Records at the same place"
  of        az
  filter    BP
  require   |shift| <= 2 m or |shift - siblings(shift)| > 2 m
  concerns  record
  cause     "the distance of one of the two records is shifted or scaled"
  note      "A shift moves the section, at both ends of the body alike; up to 2 m are within the accuracy of"
            "the synchronisation."

plausibility running_speed "Speed from distance and time against the table of sections"
  require    range of running_distance / range of clock near speed within 3 %
  concerns   record
  otherwise  not used
  cause      "the clock, the scale of the distance, or the speed of the table"
  note       "A section is run at constant speed. A table with nominal speeds may be off by 2 km/h."

plausibility clock "Speed from distance and time against the table, over all sections"
  require   range of running_distance / range of clock near speed within 10 km/h
  over      sections
  slope     0.985 to 1.015
  concerns  record
  cause     "the clock or the scale of the distance of one of the records, or the speeds of the table"
  note      "Single sections may be run a little off the speed of the table; all together are not."

plausibility test_speed "Speed of the table against the admissible speed"
  require    speed <= 1.1 * admissible_speed + 10 km/h
  otherwise  not assessable
  cause      "the admissible speed of the vehicle file, or the speeds of the table of sections"
  note       "The test speed is at most 1.1 times the admissible one; 10 km/h are allowed for the run. The"
             "length of the sections depends on the admissible speed."

plausibility table_of_curves "Cant deficiency against speed, radius and cant"
  require    |cant_deficiency| near |1500 mm * (speed^2 / radius / 9.80665 m/s^2) - cant| within 15 mm
  concerns   record
  unless     direction is straight
  otherwise  not used
  cause      "radius, speed, cant or cant deficiency of the table of sections"

plausibility track_curvature "Curvature of the track file against radius and direction"
  require    mean of curvature near turn / radius within 3 %
  concerns   record
  unless     direction is straight
  otherwise  not used
  cause      "radius, direction or place of the section, or the track file of another section"

plausibility track_straight "Straight sections against the track file"
  require    |mean of curvature| <= 0.0002 1/m
  concerns   record
  unless     direction is not straight
  otherwise  not used
  cause      "direction or place of the section, or the track file of another section"

plausibility track_cant "Cant of the track file against the table"
  require    mean of track_cant near turn * cant within 15 mm
  concerns   record
  unless     direction is straight
  otherwise  not used
  cause      "cant or direction of the section, or the track file of another section"

plausibility total_load "Vertical forces of all wheels against the static load, over all sections"
  of       TotalQ
  require  median near 8 * Q0 within 11 %
  over     sections
  cause    "Q0 of the vehicle file, a gain of the vertical forces, or the load of another state"
  note     "A payload that nobody modelled adds up to 9 %. In sound campaigns without payload the sum is"
           "within 2.5 %."

plausibility modelled_load "Simulated vertical forces of all wheels against the static load, over all sections"
  of       TotalQ
  require  simulated(median) near 8 * Q0 within 4 %
  over     sections
  cause    "the masses of the model, or Q0 of the vehicle file"
  note     "A simulation has the load that it was given: in sound campaigns it is within 2.5 % of the static"
           "load."

plausibility vertical_siblings "Vertical forces of the two wheels on one side of a bogie"
  of       SiblingsI at each side
  of       SiblingsII at each side
  require  measured(median) near simulated(median) within 0.085 * Q0
  over     sections
  cause    "a gain or an offset of one of the two channels on one side"
  note     "Payload, wind, cant and springs act on both wheels alike. In 38 sound campaigns both sides differ"
           "by at most 6.5 % of Q0."

plausibility vertical_drift "Drift of a vertical wheel force over the campaign"
  of       SiblingsI at each side
  of       SiblingsII at each side
  require  measured(median) near simulated(median) within 0.08 * Q0
  over     order of sections
  cause    "drift of the zero or of the gain of one of the two channels on one side, over the campaign"
  note     "Load, wind and wear act on both wheels alike. The sections are in the order of the table."

plausibility vertical_agreement "Gain of a vertical wheel force between simulation and measurement"
  of       Q
  require  measured(median) near simulated(median) within 500 kN
  over     sections
  slope    0.65 to 1.4
  cause    "the cants of the table of sections; a gain of the channel on one side"
  note     "Over right-hand and left-hand curves. Worn wheels and soft springs change it to 0.76 and 1.32."
           "Payload and wind move all sections alike, not the slope: the tolerance is wide."

plausibility static_load "Vertical wheel force against the static load"
  of         SigmaQ at each wheelset
  require    median near 2 * Q0 within a factor of 1.4
  otherwise  not used
  cause      "the load of an axle, a bogie or the vehicle instead of that of a wheel; another load condition"
  note       "A payload adds up to one third; the smallest likely error, the load of an axle, is a factor of"
             "2."

plausibility load_transfer_gain "Load transfer to the outer wheels, over all sections"
  of         DeltaQ at each wheelset
  require    median near 4 * Q0 / 9.80665 m/s^2 * unbalanced_acceleration within 100 kN
  over       sections
  slope      0.1 to 3
  unless     direction is straight
  otherwise  not assessable
  cause      "exchange of the left and the right wheels, or the directions of the curves"
  note       "The centre of gravity lies 1 m to 2 m above the rail. A cross wind or a load on one side moves"
             "all sections alike, not the slope: the tolerance is wide."

plausibility load_transfer "Load transfer to the outer wheels"
  of         DeltaQ at each wheelset
  require    turn * median > -0.15 * Q0 - |median of TotalY + 8 * Q0 / 9.80665 m/s^2 * unbalanced_acceleration|
  unless     direction is straight or cant_deficiency < 60 mm
  otherwise  not used
  cause      "exchange of the left and the right wheel, or the direction of the curve"
  note       "With 60 mm of cant deficiency the outer wheel carries about 5 % more. A cross wind takes from"
             "it less than its own force, which the guiding forces show."

plausibility guiding_zero "Guiding forces of both sides, over all sections"
  of       Y
  require  measured(median) near simulated(median) within 0.05 * Q0 + |measured(median of TotalY) - simulated(median of TotalY)| / 4
  over     sections
  cause    "an offset of a guiding force of one side"
  note     "Friction changes guiding forces in right-hand and left-hand curves with opposite signs. A cross"
           "wind moves the sum, of which a flange carries more than one wheel's share."

plausibility guiding_drift "Drift of a guiding force over the campaign"
  of       Y
  require  measured(median) near simulated(median) within 0.08 * Q0
  over     order of sections
  cause    "drift of the zero or of the gain of a guiding force over the campaign; a wind that rises"
  note     "The sections are in the order of the table."

plausibility guiding_gain "Sum of the guiding forces over the unbalanced acceleration, over all sections"
  of       TotalY
  require  median near -(8 * Q0 / 9.80665 m/s^2) * unbalanced_acceleration within 100 kN
  over     sections
  slope    0.9 to 1.1
  unless   direction is straight
  cause    "a gain of the guiding forces; Q0, or the speeds, radii or cants of the table of sections"
  note     "The sum balances the unbalanced acceleration of the mass, whatever the suspension. In 41 sound"
           "campaigns the slope is from 0.92 to 1.06. Wind and offsets move all sections alike, not the"
           "slope: the tolerance is wide."

plausibility guiding_sign "Guiding force of the outer leading wheel"
  of         Y at wheelset 1 and side outer
  require    -turn * median > 0.08 * Q0
  unless     direction is straight or radius > 600 m
  otherwise  not used
  cause      "the sign of the guiding forces, their unit, or the direction of the curve"
  note       "In small curves the outer leading wheel guides: its guiding force is usually a quarter of the"
             "wheel load or more."

plausibility guiding_balance "Sum of the guiding forces against the unbalanced acceleration"
  of       TotalY
  require  median near -(8 * Q0 / 9.80665 m/s^2) * unbalanced_acceleration within 12 kN + 0.05 * 8 * Q0
  unless   direction is straight
  cause    "the sign or the unit of the guiding forces; a lateral load such as wind"
  note     "The sum of all guiding forces balances the unbalanced acceleration. The tolerance is about 1"
           "m/s^2 below the difference that an inverted sign causes at 100 mm of cant deficiency."

plausibility lateral_gain "Lateral acceleration over the unbalanced acceleration, over all sections"
  of       ay at each running_gear
  require  median near unbalanced_acceleration within 1 m/s^2
  over     sections
  slope    0.95 to 1.45
  unless   direction is straight
  cause    "a gain of the acceleration; the speeds, radii or cants of the table of sections"
  note     "The roll of the body adds a tenth to a third of the unbalanced acceleration. In 41 sound"
           "campaigns of three vehicles the slope is from 1.07 to 1.23."

plausibility lateral_agreement "Gain of the lateral acceleration between simulation and measurement"
  of       ay at each running_gear
  require  measured(median) near simulated(median) within 1 m/s^2
  over     sections
  slope    0.85 to 1.15
  cause    "a gain of the acceleration of one side; the speeds, radii or cants of the table of sections"
  note     "Soft springs and worn bump stops change it by up to 7 %, in 41 campaigns."

plausibility wheel_climb "Ratio Y/Q below the limit of flange climbing"
  of         YQ at each wheelset and side
  require    |median| <= 1.2
  otherwise  not used
  cause      "the unit of the guiding or of the vertical forces"
  note       "Flange climbing begins at about 1.2 for a flange angle of 70 degrees (Nadal's limit); no"
             "quasi-static value is close to it."

plausibility lateral_acceleration "Lateral acceleration against the unbalanced acceleration"
  of         ay at each running_gear
  require    median near 1.2 * unbalanced_acceleration within 0.2 m/s^2 + 0.4 * 1.2 * |unbalanced_acceleration|
  unless     direction is straight
  otherwise  not used
  cause      "the sign or the unit of the acceleration; cant, radius or speed of the section"
  note       "A sensor fixed to the body measures the unbalanced acceleration plus the component of gravity"
             "due to the roll of the body, a fifth to a third of it."

plausibility acceleration_level "Level of the car body accelerations"
  of         ay at each running_gear
  of         az at each running_gear
  filter     BP
  require    0.01 m/s^2 <= rms and rms <= 2 m/s^2
  otherwise  not used
  cause      "the unit of the acceleration, g instead of m/s^2; a sensor without a signal"
  note       "The bounds are this protocol's own: an eighth of the value of a coach on good track, and twice"
             "the value of a locomotive on poor track."

plausibility spikes "Samples out of line"
  of         Y
  of         Q
  of         ay
  of         az
  require    spike <= larger of (larger of 9 * noise_floor, 1.3 * std), 3 * siblings(spike)
             or resolution > 0.3 * std or repeated > 25 %
  otherwise  not used
  cause      "spikes, or a short dropout: single samples that do not belong to the signal"
  note       "In 78 sound campaigns single samples reach 1.2 standard deviations and 12 times the noise."
             "Shocks at joints and switches do more, but in half of the wheels. A spike that moves a"
             "percentile by a tenth of its limit reaches 5 standard deviations and 20 times the noise."

plausibility interrupted "Gaps that were filled"
  of         Y
  of         Q
  of         ay
  of         az
  require    smooth_stretch <= larger of 16, 3 * siblings(smooth_stretch) or resolution > 0.3 * std
             or repeated > 25 %
  otherwise  not used
  cause      "a dropout, or a gap that was filled with a value, a straight line or a curve"
  note       "In 78 sound campaigns measured channels follow a smooth curve over at most 13 samples,"
             "simulated ones over 21, with neighbours alike."

plausibility repeated_samples "Repeated samples"
  of         Y
  of         Q
  of         ay
  of         az
  require    repeated <= 25 %
  otherwise  not used
  cause      "a lower sampling rate of the source: each value was written several times"
  note       "At most 10 % in sound campaigns, 50 % where each value stands twice."

plausibility clipped "Peaks cut off"
  of         Y
  of         Q
  of         ay
  of         az
  require    piled_up <= 0.5 % or resolution > 0.08 * std or held >= 0.8 * at_extreme
             or piled_up <= 3 * siblings(piled_up)
  otherwise  not used
  cause      "a recorder or sensor at the end of its range: peaks are cut off"
  note       "In 78 sound campaigns at 200 Hz at most 0.4 %. Clipping that moves a percentile by a tenth of"
             "its limit piles up 0.6 % or more. A coarse signal has several samples at its largest value."

plausibility hum "Line of a fixed frequency"
  of       Y
  of       ay
  require  measured(line) <= larger of 250, 15 * siblings(measured(line))
  cause    "interference of a fixed frequency, such as that of the mains or of the traction current"
  note     "A resonance reaches 130 times the lines around it, or shows in the neighbours as well."

plausibility hum_vertical "Line of a fixed frequency"
  of       Q
  of       az
  require  measured(line) <= larger of 250, 15 * siblings(measured(line))
           or (measured(line_length) >= 2.4 m and measured(line_length) <= 4 m)
           or (measured(line_length) >= 1.2 m and measured(line_length) <= 2 m)
  cause    "interference of a fixed frequency, such as that of the mains or of the traction current"
  note     "A wheel that is out of round has a line at its circumference or half of it: 2.4 m to 4 m are"
           "wheels of 0.76 m to 1.27 m."

plausibility filtered "Noise below that of the neighbours"
  of       Y
  of       Q
  of       ay
  of       az
  require  measured(noise_floor) >= 0.25 * siblings(measured(noise_floor))
           or measured(noise_floor) * siblings(measured(std)) >= 0.25 * siblings(measured(noise_floor)) * measured(std)
           or measured(resolution) > 0.3 * measured(std) or measured(repeated) > 25 %
  cause    "a filter or a smoothing that the other channels did not pass"
  note     "In 78 sound campaigns a channel has at least 56 % of the noise of its neighbours, a smoothed one"
           "at most 11 %."

plausibility noisy "Noise above that of the neighbours"
  of       Q
  of       ay
  of       az
  require  measured(noise_floor) <= 2.2 * siblings(measured(noise_floor)) or measured(line) > 250
           or measured(noise_floor) * siblings(measured(std)) <= 2.2 * siblings(measured(noise_floor)) * measured(std)
  cause    "noise or interference of the measuring chain of this channel, or the signal of another sensor"
  note     "In 78 sound campaigns at most 1.8 times."

plausibility noisy_guiding "Noise above that of the neighbours"
  of       Y
  require  measured(noise_floor) <= 3.5 * siblings(measured(noise_floor))
           or measured(noise_floor) * siblings(measured(std)) <= 3.5 * siblings(measured(noise_floor)) * measured(std)
  cause    "noise or interference of the measuring chain of this channel"
  note     "Guiding wheels hit the rail more often than others: at most 2.7 times in 78 sound campaigns."

plausibility exchanged_folders "Noise of the simulation above that of the measurement"
  of        Y
  of        Q
  of        ay
  of        az
  require   siblings(simulated(noise_floor)) <= larger of 2 * siblings(measured(noise_floor)),
            0.002 * simulated(std)
  concerns  record
  cause     "simulation and measurement are exchanged; a filter that only the measurement passed"
  note      "A simulation has less noise: at most 0.7 times that of the measurement in 14 sound campaigns."

plausibility lacking "Bands that one side lacks"
  of       Y
  of       Q
  of       ay
  of       az
  require  least_ratio_of_spectra(1 Hz, 10 Hz) >= 0.01
  over     sections
  cause    "a filter that one of the two records passed: it takes a part of the band away"
  note     "Errors of a model change the spectral density of a band by a factor of ten, not of a hundred."

plausibility noisy_simulation "Noise above that of the neighbours"
  of       Y
  of       Q
  of       ay
  of       az
  require  simulated(noise_floor) <= larger of 5 * siblings(simulated(noise_floor)), 0.002 * simulated(std)
           or simulated(resolution) > 0.1 * simulated(std)
  cause    "noise that was added to a simulated channel"
  note     "In 78 sound campaigns at most 3.8 times."

plausibility unloaded "Vertical wheel force near zero"
  of       Q
  require  minimum >= 0.05 * Q0
  cause    "a dropout of the vertical force, or a wheel that lifts: the ratio Y/Q has no meaning there"
  note     "A ratio is not defined where its denominator comes near zero."

plausibility noise "Noise of a channel"
  of       Q
  of       ay
  of       az
  require  noise_floor <= larger of 0.6 * std, 1.5 * siblings(noise_floor)
  cause    "interference in the measuring chain, or a sensor that is not connected"
  note     "Noise of more than 60 % of the standard deviation hides the signal. In 138 sound sections at 200"
           "Hz it is at most 41 % for Q and 20 % for accelerations. At 100 Hz the signal itself changes from"
           "sample to sample, in all channels alike. Guiding forces on straight track are small against their"
           "noise and are not checked."

plausibility freight_suspension "Category and suspension"
  require  not (vehicle.category is freight and vehicle.secondary_suspension)
  cause    "the category of the vehicle file: limits of acceleration are doubled for freight wagons"
  note     "Freight wagons seldom have a secondary suspension."

plausibility single_axles "Running gear and wheelsets"
  of         SigmaY at wheelset 3
  require    not (vehicle.running_gear_type is single_axles)
  otherwise  not assessable
  cause      "the running gear of the vehicle file: a vehicle with single axles has two wheelsets"

sections
  use          sections
  zone         zone
  faulty       not used
  percentiles  percentile_rule

quantity Y_qst "Quasi-static guiding force"
  symbol      "Y_qst"
  of          Y at wheelsets evaluated_wheelsets
  filter      LP20
  value       median
  difference  quasi_static_difference
  limit       std 5 kN
  limit       mean mean_limit_share of limit of std
  source      "Table 1"

quantity Q_qst "Quasi-static vertical wheel force"
  symbol      "Q_qst"
  of          Q at wheelsets evaluated_wheelsets
  filter      LP20
  value       median
  difference  quasi_static_difference
  limit       std 4 kN * (1 + 0.01 * Q0/kN)
  limit       mean mean_limit_share of limit of std
  source      "Table 1"

quantity YQ_qst "Quasi-static ratio Y/Q"
  symbol      "(Y/Q)_qst"
  of          YQ at wheelsets evaluated_wheelsets
  filter      RATIO
  value       median
  difference  quasi_static_difference
  limit       std 0.07
  limit       mean mean_limit_share of limit of std
  source      "Table 1"

quantity SigmaY_qst "Quasi-static sum of guiding forces"
  symbol      "ΣY_qst"
  of          SigmaY at wheelsets evaluated_wheelsets
  filter      LP20
  value       median
  difference  quasi_static_difference
  limit       std 6 kN
  limit       mean mean_limit_share of limit of std
  source      "Table 1"

quantity Y_max "Guiding force, maximum"
  symbol      "Y_max"
  of          Y at wheelsets evaluated_wheelsets
  filter      LP20
  value       extreme_value
  difference  magnitudes
  limit       std 9 kN
  limit       mean mean_limit_share of limit of std
  source      "Table 1"
  note        "Absolute values of simulation and measurement."

quantity Q_max "Vertical wheel force, maximum"
  symbol      "Q_max"
  of          Q at wheelsets evaluated_wheelsets
  filter      LP20
  value       p99.85
  difference  magnitudes
  limit       std 6 kN * (1 + 0.01 * Q0/kN)
  limit       mean mean_limit_share of limit of std
  source      "Table 1"
  note        "Absolute values of simulation and measurement."

quantity YQ_max "Ratio Y/Q, maximum"
  symbol      "(Y/Q)_max"
  of          YQ at wheelsets evaluated_wheelsets
  filter      RATIO_WINDOW
  value       extreme_value
  difference  magnitudes
  limit       std 0.1
  limit       mean mean_limit_share of limit of std
  source      "Table 1"
  note        "Absolute values of simulation and measurement."

quantity SigmaY_max "Sum of guiding forces, maximum"
  symbol      "ΣY_max"
  of          SigmaY at wheelsets evaluated_wheelsets
  filter      WINDOW
  value       extreme_sum
  difference  magnitudes
  limit       std 9 kN
  limit       mean mean_limit_share of limit of std
  source      "Table 1"
  note        "Absolute values of simulation and measurement."

quantity ay_rms "Car body lateral acceleration, rms value"
  symbol      "ÿ*_rms"
  of          ay at running gears I, II
  filter      BP
  value       rms
  difference  signed
  limit       std 0.15 m/s^2, doubled when lighter_requirements
  limit       mean mean_limit_share of limit of std
  source      "Table 1"

quantity az_rms "Car body vertical acceleration, rms value"
  symbol      "z̈*_rms"
  of          az at running gears I, II
  filter      BP
  value       rms
  difference  signed
  limit       std 0.15 m/s^2, doubled when lighter_requirements
  limit       mean mean_limit_share of limit of std
  source      "Table 1"

quantity ay_max "Car body lateral acceleration, maximum"
  symbol      "ÿ*_max"
  of          ay at running gears I, II
  filter      BP
  value       extreme_lateral
  difference  magnitudes
  limit       std 0.4 m/s^2, doubled when lighter_requirements
  limit       mean mean_limit_share of limit of std
  source      "Table 1"
  note        "Absolute values of simulation and measurement."

quantity az_max "Car body vertical acceleration, maximum"
  symbol      "z̈*_max"
  of          az at running gears I, II
  filter      BP
  value       extreme_vertical
  difference  magnitudes
  limit       std 0.4 m/s^2, doubled when lighter_requirements
  limit       mean mean_limit_share of limit of std
  source      "Table 1"
  note        "Absolute values of simulation and measurement."

verdict
  validated           when every limit holds
  minimum signals     2
  minimum pairs       24
  standard deviation  variance_divisor
