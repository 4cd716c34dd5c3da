//! Sections to their values: the half of a run that reads records.
//!
//! | file | content |
//! |---|---|
//! | `prepared` | what is opened and checked before any record is read |
//! | `section` | the values of one section |
//! | `shards` | all sections, or a part of them |

mod prepared;
pub mod section;
pub mod shards;

pub use prepared::{Prepared, Progress};
pub use section::wanted_of;
pub use shards::{Numbered, Shard};
