//! Estimates against their limits.
//!
//! | file | content |
//! |---|---|
//! | `against` | a number against a limit |
//! | `bound` | the limit of one group of rows, and those that it refers to |
//! | `factors` | factors of limits that apply because of vehicle data |
//! | `limits` | estimates compared with limits, group by group |
//! | `together` | simulations that meet limits together, and not alone |
//! | `pool` | all values and limits, for selections of sections |
//! | `keep` | the selection that keeps the scatter, as a step of the protocol |

mod against;
mod bound;
mod factors;
pub mod keep;
mod limits;
pub mod pool;
mod together;

pub use limits::{Compared, Estimated, Judging, applying, rule_place};
