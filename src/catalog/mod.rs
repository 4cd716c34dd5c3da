//! The registry of operations on signals and numbers: reducers, statistics, functions, filter
//! steps, metrics.
//!
//! Each entry has a name, a signature and a description. Checker, run, `explain` and the language
//! reference use the same tables.

mod entries;
mod forms;
mod functions;
mod reducers;
mod steps;
mod two_signals;

pub use entries::{Entry, entries};
pub use forms::{Choice, Form, FormPart, NumberOption};
pub use functions::{FUNCTIONS, Function, SIGNAL_FUNCTIONS, Signature};
pub use reducers::{
    CROSSINGS, InWindow, LONGEST_RUN, REDUCERS, Reducer, ReducerEntry, SHARE_OF_SAMPLES,
    STATISTICS, Statistic, StatisticEntry, TOTAL,
};
pub use steps::{STEPS, StepEntry, StepKind};
pub use two_signals::{Asked, Best, METRICS, Metric, MetricEntry, NOT_CHECKED, Pair};

/// Named differences of a simulated and a measured value, as name and expression.
pub const DIFFERENCES: [(&str, &str); 3] = [
    ("oriented", "sign(measured) * (simulated - measured)"),
    ("magnitudes", "|simulated| - |measured|"),
    ("signed", "simulated - measured"),
];
