protocol en14363-2016-annex-t-population-deviation "EN 14363:2016 Annex T with the standard deviation by n"
  extends  en14363-2016-annex-t
  author   "Fishplate, as an example of a study"
  scope    "How much the verdict depends on the divisor of the variance, which the paper leaves open: n in"
           "place of n-1, 2.1 % at 24 pairs."

parameter variance_divisor
  default  n
