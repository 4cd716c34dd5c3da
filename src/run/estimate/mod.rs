//! Groups of rows, and what is estimated from them.
//!
//! | file | content |
//! |---|---|
//! | `table` | rows with their sections |
//! | `groups` | the groups that a limit applies to |
//! | `rows` | the rows of a quantity, and why they are not sufficient |
//! | `estimates` | estimates from the rows of a group |
//! | `extrapolation` | regressions that are read outside their data |

mod estimates;
pub mod extrapolation;
mod groups;
mod rows;
mod table;

pub use groups::{Closeness, Group, RowGroup};
pub use rows::{Rows, TooFew, Used, absent, used};
pub use table::{Member, Table, count_independent, independent_of};
