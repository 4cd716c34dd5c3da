//! Groups of rows, and what is estimated from them.

pub mod estimates;
pub mod extrapolation;
pub mod groups;
pub mod minima;
pub mod table;

pub use estimates::{Group, Taken};
pub use groups::{Closeness, Grouped, Part, parts};
pub use minima::TooFew;
pub use table::{Member, Row, Table, count_independent};
