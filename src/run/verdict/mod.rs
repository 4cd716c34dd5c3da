//! From rows and limits to results of quantities and verdicts.
//!
//! | file | content |
//! |---|---|
//! | `verdicts` | verdicts from limits, from other verdicts, or left to a person |
//! | `judge` | results of quantities, and all verdicts |
//! | `evaluated` | a campaign with every section evaluated: what is judged |
//! | `changed` | the verdict with another limit, from the estimates |
//! | `replay` | a verdict again from the values of a result |

mod changed;
mod evaluated;
mod judge;
pub mod replay;
mod verdicts;

pub use changed::{LimitChange, limit_changes};
pub use evaluated::{Evaluated, all_values};
pub use judge::Judged;
pub use verdicts::{Given, overall};
