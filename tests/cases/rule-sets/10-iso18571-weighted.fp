protocol iso18571-weighted "ISO 18571 rating averaged over channels with weights and grade words"
  extends  "base.fp"

parameter w_Y "Weight of Y"
  default  0.5

parameter w_Q "Weight of Q"
  default  0.3

parameter w_ay "Weight of ay"
  default  0.2

quantity Q_rating "Rating of Q"
  of        Q at wheelsets 1, 3
  filter    LP20
  metric    iso18571 overall
  reported  "Enters the weighted rating."

quantity ay_rating "Rating of ay"
  of        ay
  filter    band-pass 0.4 Hz to 10 Hz
  metric    iso18571 overall
  reported  "Enters the weighted rating."

quantity rating "Rating of Y, and weighted rating of all"
  of       Y at wheelsets 1, 3
  filter   LP20
  metric   iso18571 overall
  report   combined
  outcome  excellent: holds when combined > 0.94
  outcome  good: holds when combined > 0.8
  outcome  fair: holds when combined > 0.58
  outcome  poor: fails

estimate combined "Weighted rating of all channels"
  is  w_Y * mean + w_Q * mean of Q_rating + w_ay * mean of ay_rating
