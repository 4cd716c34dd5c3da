protocol uic518-2009-comparison "Comparison of simulation and on-track test, judged by a person, UIC 518:2009 kind"
  extends  en14363-2016-annex-t
  edition  "Similar to UIC 518:2009, validation of simulation models"
  source   "From memory of UIC 518:2009: quantities of the on-track test, time histories and a reviewer's"
           "judgement"
  author   "Fishplate"
  scope    "The quantities of an on-track test, simulated and measured, section by section: differences,"
           "their mean and standard deviation, and time histories. A reviewer judges each class of quantities"
           "and the model as a whole; the program never does. The limits of Annex T are reference lines here"
           "and decide nothing."
  note     "The text of UIC 518:2009 was not to hand. The quantities and filters are those of Annex T."

verdict
  validated  when model holds
  words      sufficient, not sufficient

verdict model "Agreement of simulation and test"
  judged by  "the independent reviewer"
  words      sufficient, not sufficient

verdict {class} "{title}"
  for each   class, title in (running_safety, "Running safety: Y/Q and sum of guiding forces"),
             (track_loading, "Track loading: guiding and vertical wheel forces"),
             (ride, "Ride: accelerations of the car body"),
             (time_histories, "Time histories: shape, frequencies, phase")
  judged by  "the independent reviewer"
  words      sufficient, not sufficient

verdict reference_lines "All values within the reference lines (Annex T), for orientation"
  holds  when every limit holds
  words  within, beyond
