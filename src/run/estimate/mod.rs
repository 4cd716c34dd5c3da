//! Groups of rows, and what is estimated from them.
//!
//! | file | content |
//! |---|---|
//! | `table` | rows with their sections |
//! | `groups` | the groups that a limit applies to |
//! | `minima` | groups with fewer pairs than required |
//! | `rows` | the rows of a quantity, and why they are not sufficient |
//! | `estimates` | estimates from the rows of a group |
//! | `extrapolation` | regressions that are read outside their data |

mod estimates;
pub mod extrapolation;
mod groups;
mod minima;
mod rows;
mod table;

pub use estimates::Group;
pub use groups::{Closeness, Grouped, Part, parts};
pub use minima::TooFew;
pub use rows::{Rows, Used, members};
pub use table::{Member, Table, count_independent};
