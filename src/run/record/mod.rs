//! One record through the signal nodes of the graph.
//!
//! | file | content |
//! |---|---|
//! | `signal` | samples along a record, and the operations on them |
//! | `trial` | records with a known disturbance |
//! | `memo` | results of nodes by what the nodes do |
//! | `opened` | a record that was read and checked for a section |
//! | `section_records` | the records of a section that several protocols share |
//! | `state` | the nodes of the graph, level by level |
//! | `stretch` | records that neighbouring sections share |
//! | `calibrate` | the values of nodes with channels that are calibrated otherwise |
//! | `evaluate` | the values of nodes, also with the record moved along its axis |
//! | `work` | the reading of a record for its nodes |

mod calibrate;
mod evaluate;
mod memo;
mod opened;
mod section_records;
pub mod signal;
mod state;
mod stretch;
pub mod trial;
mod work;

pub use calibrate::{Calibrated, Line, Lines};
pub use evaluate::Held;
pub use memo::{Keys, Numbers};
pub use opened::{Fault, Opened, file_hash};
pub use section_records::{Columns, Counts, SectionRecords, Sharing};
pub use signal::{Along, Rate, Samples, Signal, apply, arithmetic, choose, each, mapped};
pub use state::NodeValue;
pub use stretch::{Soundness, Stretches};
pub use trial::Trial;
pub use work::{SectionWork, Work};
