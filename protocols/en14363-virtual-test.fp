protocol en14363-virtual-test "On-track assessment of the simulated vehicle (virtual test), EN 14363 normal method"
  extends  en14363-on-track-assessment
  author   "Fishplate"
  scope    "As the parent, of the simulated records. A virtual test asks for a validated model; this protocol"
           "does not check that."

quantity {name}
  for each  name in SigmaY_max, YQ_max, SigmaY_instability, ayb_rms, Q_max, Y_qst, Q_qst, B_qst, ay_max,
            az_max, ay_rms, az_rms, ay_qst
  from      simulated
