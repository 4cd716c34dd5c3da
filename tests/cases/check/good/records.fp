protocol records "Codes and runs by name"
  extends  en14363-2016-annex-t

record reference "Reference code"
  is  simulated gamma

record codes "Codes under test"
  is  simulated alpha, "beta 2"

record runs "Runs"
  is  measured

quantity Y_qst
  compare  codes with reference
  limit    std 5 kN for each record

quantity Q_qst
  compare  runs with each other

quantity YQ_qst
  compare  codes with mean of simulated

quantity SigmaY_qst
  compare  codes with measured

quantity agreement "Correlation with the reference code"
  of       Q at wheelsets 1, 3
  filter   LP20
  compare  codes with reference
  metric   correlation
  limit    mean at least 0.9

quantity level "Wheel force of the reference code"
  of     Q at wheelsets 1, 3
  from   reference
  value  mean
  limit  mean 100 kN for each campaign
  limit  p95 120 kN for sections where campaign is "series 2" or campaign is series_1
