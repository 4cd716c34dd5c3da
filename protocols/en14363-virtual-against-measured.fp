protocol en14363-virtual-against-measured "Acceptance by the simulated and by the measured on-track test, side by side"
  extends  en14363-on-track-assessment
  author   "Fishplate"
  scope    "Whether the virtual test gives the same acceptance as the measured one: both are assessed by the"
           "rules of the parent, and their verdicts are compared as a whole and for each class of quantities."
  note     "That both are accepted says little of the model if all values are far from their limits."

quantity {name}_simulated "{title}, simulated"
  for each  name, sign, title in (SigmaY_max, "ΣY_max", "Sum of guiding forces, maximum"),
            (YQ_max, "(Y/Q)_max", "Ratio Y/Q, maximum"),
            (SigmaY_instability, "ΣY_rms", "Instability: sum of guiding forces"),
            (ayb_rms, "ÿ+_rms", "Instability: lateral acceleration of the bogie frame"),
            (Q_max, "Q_max", "Vertical wheel force, maximum"),
            (Y_qst, "Y_qst", "Guiding force, quasi-static"),
            (Q_qst, "Q_qst", "Vertical wheel force, quasi-static"),
            (B_qst, "B_qst", "Combined rail loading, quasi-static"),
            (ay_max, "ÿ*_max", "Lateral acceleration of the car body, maximum"),
            (az_max, "z̈*_max", "Vertical acceleration of the car body, maximum"),
            (ay_rms, "ÿ*_rms", "Lateral acceleration of the car body, rms value"),
            (az_rms, "z̈*_rms", "Vertical acceleration of the car body, rms value"),
            (ay_qst, "ÿ*_qst", "Lateral acceleration of the car body, quasi-static")
  like      {name}
  symbol    "{sign},sim"
  from      simulated

verdict
  validated  when same_acceptance holds
  words      same acceptance, other acceptance

verdict same_acceptance "The virtual test has the same outcome as the measured test"
  holds  when virtual_test is measured_test
  words  agrees, differs

verdict measured_test "Measured test"
  of     measured
  holds  when every limit holds
  words  accepted, not accepted

verdict virtual_test "Virtual test"
  of     simulated
  holds  when every limit holds
  words  accepted, not accepted

verdict virtual_running_safety "Running safety, virtual test"
  of     SigmaY_max_simulated, YQ_max_simulated
  holds  when every limit holds
  words  met, not met

verdict virtual_stability "Stability, virtual test"
  of     SigmaY_instability_simulated, ayb_rms_simulated
  holds  when every limit holds
  words  met, not met

verdict virtual_track_loading "Track loading, virtual test"
  of     Q_max_simulated, Y_qst_simulated, Q_qst_simulated, B_qst_simulated
  holds  when every limit holds
  words  met, not met

verdict virtual_ride "Ride characteristics, virtual test"
  of     ay_max_simulated, az_max_simulated, ay_rms_simulated, az_rms_simulated, ay_qst_simulated
  holds  when every limit holds
  words  met, not met

verdict {class}_agrees "{title}, virtual against measured test"
  for each  class, title in (running_safety, Running safety), (stability, Stability),
            (track_loading, Track loading), (ride, Ride characteristics)
  holds     when virtual_{class} is {class}
  words     agrees, differs
