//! Reads and writes campaigns. Nothing read is trusted before it is checked, and no channel, quantity or column is known here:
//! what is needed is asked for by the caller.
//!
//! | file | what |
//! |---|---|
//! | `campaign` | a campaign folder: `campaign.yaml`, the vehicle, the sections, where the records are |
//! | `identification` | what the campaign says the report is known by |
//! | `record` | one sampled record, the hot path |
//! | `table` | a small table such as `sections.csv` |
//! | `crate::yaml` | YAML with the place of every word |
//! | `origin` | what made the records of a campaign that a program wrote |
//! | `sites` | which sections are the same stretch of track |
//! | `checks` | whether the samples of a record can be evaluated |
//! | `fingerprint` | a file of a campaign as it lies on the disk now |
//! | `write` | every file the program makes |

pub mod campaign;
mod cells;
pub mod checks;
mod faults;
pub mod fingerprint;
mod folder;
pub mod hash;
pub mod identification;
pub mod origin;
pub mod record;
pub mod sites;
pub mod table;
pub mod text;
pub mod write;

pub use campaign::{Campaign, RecordKind};
pub use cells::Heading;
pub use checks::{Axis, check_axis};
pub use folder::Place;
pub use record::{Column, Record, Wanted, read_record};
pub use table::Table;
