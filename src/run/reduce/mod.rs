//! Sections to their values: the half of a run that reads records.

pub mod section;
pub mod several;
pub mod shards;
pub mod single;

pub use section::wanted_of;
