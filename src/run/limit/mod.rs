//! Estimates against their limits.

pub mod keep;
pub mod limits;
pub mod pool;
pub mod together;

pub use limits::{Estimated, Judging, applying, compared, rule_place};
