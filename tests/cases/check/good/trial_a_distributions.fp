protocol trial-a-distributions "Agreement of distributions after Bogojevic and Lucanin"
  extends  sprague-geers

remove
  quantity  every

quantity matching "Probability of agreement, 50 points of each distribution"
  of      Q at wheelset 1 and side L
  filter  LP20
  metric  matching probability, 50 points
  limit   p5 at least 0.05

quantity matching_of_windows "The same of the means of 2 m"
  of      Q at wheelset 1 and side L
  filter  LP20, then sliding mean 2 m every 0.5 m
  metric  matching probability, 50 points
  limit   p5 at least 0.05

quantity matching_on_grid "The same on equal steps of length"
  of      Q at wheelset 1 and side L
  filter  LP20, then resample every 5 m
  metric  matching_probability
  limit   p5 at least 0.05

quantity means "Agreement of the means by formula"
  of      Q at wheelset 1 and side L
  filter  LP20
  metric  1 - |measured(mean) - simulated(mean)| / larger of |measured(mean)|, |simulated(mean)|
  limit   each at least 0.9

quantity variances "Ratio of the variances by formula"
  of      Q at wheelset 1 and side L
  filter  LP20
  metric  (simulated(std) / measured(std))^2
  limit   each 2

quantity of_both "Probability, and the smaller over the larger scatter"
  of      Q at wheelset 1 and side L
  filter  LP20
  metric  0.5 * matching_probability(50) + 0.5 * (smaller of simulated(std), measured(std)) / (larger of simulated(std), measured(std))
  limit   p5 at least 0.4

quantity area "Area between the distributions over the measured scatter"
  of      Q at wheelset 1 and side L
  filter  LP20
  metric  area_between_distributions / measured(std)
  limit   each 0.5
