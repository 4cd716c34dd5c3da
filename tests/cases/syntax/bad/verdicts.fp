protocol p

verdict
  validated  when every limit holds

verdict
  holds  when every limit holds

verdict inspection
  judged by  "an engineer"

verdict inspection
  validated  when every limit holds
