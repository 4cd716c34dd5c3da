//! From rows and limits to results of quantities and verdicts.
//!
//! | file | content |
//! |---|---|
//! | `quantities` | results of quantities |
//! | `draws` | the same in draws of the sections |
//! | `verdicts` | verdicts from limits, from other verdicts, or left to a person |
//! | `judge` | all verdicts, and what bars them |
//! | `evaluated` | a campaign with every section evaluated: what is judged |
//! | `changed` | the verdict with another limit, from the estimates |
//! | `replay` | a verdict again from the values of a result |

mod changed;
mod draws;
mod evaluated;
mod judge;
mod quantities;
pub mod replay;
mod verdicts;

pub use changed::{LimitChange, limit_changes};
pub use evaluated::{Evaluated, all_values};
pub use judge::Judged;
pub use verdicts::{Given, overall};
