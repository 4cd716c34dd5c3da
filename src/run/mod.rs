//! Executes a graph over a campaign: records in parallel, one at a time per worker, to plain
//! results. The steps in their order:
//!
//! | folder | step |
//! |---|---|
//! | `sections` | the sections of the campaigns, and what is known before any record is read |
//! | `record` | one record through the signal nodes of the graph |
//! | `values` | the records of a section to rows of the table of values |
//! | `data_rules` | what is asked of the data: checks, plausibility, copies |
//! | `reduce` | sections to their values |
//! | `estimate` | groups of rows, and what is estimated from them |
//! | `limit` | estimates against their limits; the same for selections of sections |
//! | `describe` | what a report tells beside the verdict |
//! | `verdict` | results of quantities and verdicts; the same from the values of a result |
//! | `campaign` | all steps: by one protocol, by several, for one value |
//! | `find` | before all others where a campaign has runs: sections are looked for in them |
//! | `needs` | what the steps read, known from the protocol alone |

mod campaign;
mod check_data;
mod data_rules;
mod describe;
mod estimate;
pub mod find;
mod limit;
pub mod needs;
mod prelude;
mod record;
mod reduce;
mod sections;
mod values;
mod verdict;

pub use campaign::{
    Outcome, Reduced, Settings, again, evaluate, evaluated, hold, judge, reduce, run, several,
    single,
};
pub use check_data::check_data;
pub use data_rules::consequence::consequence;
pub use describe::traces::{Kept, Signals};
pub use limit::{keep, pool};
pub use record::{Counts, file_hash, trial};
pub use record::{Line, Lines};
pub use reduce::held::{Change, Holding};
pub use reduce::{Numbered, Progress, Shard};
pub use sections::{Basis, Facts, Unit, scalar};
pub use values::{Offset, Print, Row, SectionValues, Shifts};
pub use verdict::{Evaluated, Given, Judged, LimitChange, limit_changes, overall, replay};
