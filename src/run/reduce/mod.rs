//! Sections to their values: the half of a run that reads records.
//!
//! | file | content |
//! |---|---|
//! | `prepared` | what is opened and checked before any record is read; all sections, or a part of them |
//! | `section` | the values of one section |
//! | `held` | the same again, with the measurement changed and without reading it again |

pub mod held;
mod prepared;
pub mod section;

pub use prepared::{Numbered, Prepared, Progress, Shard};
pub use section::wanted_of;
