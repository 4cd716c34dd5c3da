protocol records "Records that cannot be meant"
  extends  en14363-2016-annex-t

record originals "A word of the language"
  is  simulated

record sensors "No side"
  is  mesured sensors

record twice "One member twice"
  is  simulated alpha, beta, alpha

record gap "A member without a name"
  is  simulated alpha, , beta

record reference "Reference code"
  is  simulated gamma

record codes "Codes under test"
  is  simulated alpha, beta

quantity Y_qst
  compare  code with reference

quantity Q_qst
  compare  reference with each other

quantity YQ_qst
  compare  measured with codes

quantity SigmaY_qst
  compare  codes with codes

quantity Y_max
  compare  codes with mean of measured

quantity Q_max
  compare  codes and reference

quantity YQ_max
  value    p99.85 when speed > "fast"
