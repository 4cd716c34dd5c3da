//! From rows and limits to results of quantities and verdicts.

pub mod basis;
pub mod judge;
pub mod replay;
pub mod verdicts;

pub use basis::{Basis, without_unused_originals};
pub use judge::{Rows, members, rows};
