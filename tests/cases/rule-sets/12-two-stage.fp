protocol two-stage "Annex T with a second stage: one of 12 may fail by less than 20 %"
  extends  en14363-2016-annex-t

parameter relaxation "How far one quantity may exceed its limits"
  default  1.2

parameter sections_per_zone
  default  2

quantity {q}_relaxed "{q} with relaxed limits"
  for each    q, d in (Y_qst, oriented), (Q_qst, oriented), (YQ_qst, oriented), (SigmaY_qst, oriented),
              (Y_max, magnitudes), (Q_max, magnitudes), (YQ_max, magnitudes), (SigmaY_max, magnitudes),
              (ay_rms, signed), (az_rms, signed), (ay_max, magnitudes), (az_max, magnitudes)
  like        {q}
  difference  {d} / relaxation

verdict
  outcome  validated: holds when strict holds
  outcome  validated with restriction: holds when eleven holds and relaxed holds
  outcome  not validated: fails

verdict strict "All 12 within their limits"
  of     Y_qst, Q_qst, YQ_qst, SigmaY_qst, Y_max, Q_max, YQ_max, SigmaY_max, ay_rms, az_rms, ay_max, az_max
  holds  when every limit holds

verdict eleven "At least 11 of 12 within their limits"
  of     Y_qst, Q_qst, YQ_qst, SigmaY_qst, Y_max, Q_max, YQ_max, SigmaY_max, ay_rms, az_rms, ay_max, az_max
  holds  when at least 11 quantities hold

verdict relaxed "All within 120 % of their limits"
  of     {q}_relaxed
  holds  when every limit holds
