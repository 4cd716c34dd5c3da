protocol en14363-2016-annex-t-population-deviation "EN 14363:2016 Annex T with the divisor n of the variance"
  extends  en14363-2016-annex-t
  author   "Fishplate, as an example of a study"
  scope    "Influence of the divisor of the variance, which the paper does not specify: n instead of n-1, a"
           "difference of 2.1 % at 24 pairs."

parameter variance_divisor
  default  n
