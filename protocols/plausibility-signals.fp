# Rules of plausibility that need no name of a channel. A protocol shares them with `uses  plausibility-signals`,
# and changes one of them with a block of the same name.

protocol plausibility-signals "Plausibility of the channels that quantities read"
  author  "Fishplate"
  scope   "For every kind of machine: each rule is checked at every recorded position of the channels that"
          "quantities of the protocol read."
  axis    distance in m
  time    time in s
  note    "The axis is that of the protocol which uses this text; the one here serves its own check."

plausibility copies "Copies of records"
  of         every channel
  distinct   channels, sections, sides
  concerns   record
  otherwise  not used
  cause      "a record or channel written twice"

plausibility live "Constant channel"
  of         every channel
  require    held <= 5 % or resolution > 0.1 * std
  otherwise  not used
  cause      "a channel without a signal, or an interrupted one"
  note       "In a working channel, the longest run of equal samples is at most 2 % of a section. With few"
             "decimals, a quiet channel has longer ones."

plausibility saturated "Saturated channel"
  of         every channel
  require    at_extreme <= 2 % or held >= 0.8 * at_extreme or resolution > 0.1 * std
  otherwise  not used
  cause      "a recorder or sensor at the end of its range"
  note       "A working channel is at its largest or smallest value in less than 1 % of the samples. A single"
             "run of equal values is a dropout, which `interrupted` and `live` tell."

plausibility coarse "Channel with coarse resolution"
  of         every channel
  require    resolution <= 0.5 * std
  otherwise  not used
  cause      "insufficient resolution of the recorder, or too few decimals"
  note       "Steps of half the standard deviation increase it by 1 % and distort percentiles. Forces with"
             "one decimal and accelerations with two have steps of up to 45 % on good track."

plausibility exchanged "Records and channels that belong together"
  of         every channel
  exchanged  from 0.6, by 0.3, alike from 0.7
  concerns   record
  otherwise  not used
  cause      "exchanged or copied channels, wheelsets, sides or sections of one of the records; a turned"
             "vehicle"
  note       "Forces of neighbouring wheels are alike: in sound sections a channel agrees with another one"
             "better than with its own by at most 0.04."

plausibility same_sign "Simulation and measurement with the same sign"
  of         every channel
  require    correlation >= -0.3
  otherwise  not used
  cause      "an inverted sign in one of the two records"
  note       "Sections of 100 m contain about 10 independent waves or more: the correlation of unrelated"
             "signals is seldom below -0.3, that of related ones never."

plausibility same_size "Scatter of simulation and measurement"
  of         every channel
  require    measured(p84) - measured(p16) near simulated(p84) - simulated(p16) within a factor of 7
  otherwise  not used
  cause      "the unit of one of the two records"
  note       "The smallest likely error, g in place of m/s^2, is a factor of 9.8."

plausibility drift "Drift of the measurement"
  of       every channel
  require  |drift| <= 1.5 * measured(std)
  cause    "drift of a measuring channel"

sections
  removed  at most 20 %
  note     "The share is this text's own: with more sections removed, what is left may no longer stand for"
           "the test."
