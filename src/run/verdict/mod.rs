//! From rows and limits to results of quantities and verdicts.
//!
//! | file | content |
//! |---|---|
//! | `verdicts` | verdicts from limits, from other verdicts, or left to a person |
//! | `judge` | results of quantities, and all verdicts |
//! | `evaluated` | a campaign with every section evaluated: what is judged |
//! | `replay` | a verdict again from the values of a result |

mod evaluated;
mod judge;
pub mod replay;
mod verdicts;

pub use evaluated::{Evaluated, all_values};
pub use judge::Judged;
