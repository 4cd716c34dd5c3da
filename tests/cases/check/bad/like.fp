protocol like "Quantities like others that are not there, or like themselves"
  extends  en14363-2016-annex-t

estimate by_zone "Another one in zone 1"
  is  mean when zone is 1, otherwise std

quantity twin "Misspelt"
  like  Y_mx
  of    Y

quantity one "Like the other"
  like  other

quantity other "Like the one"
  like  one

quantity Y_max
  limit  by_zone 9 kN
