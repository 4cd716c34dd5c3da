//! The values of one section: from the nodes of its records to rows.
//!
//! | file | content |
//! |---|---|
//! | `row` | a row of the table of values |
//! | `print` | marks of a signal, by which copies are found |
//! | `section_values` | all that the evaluation of a section gives |
//! | `common` | both sides at common points |
//! | `sides` | the records of a section; values, differences and metrics of them |
//! | `margins` | whether a record is long enough for slow filters |
//! | `one_record` | one record of a section |
//! | `shifts` | shifts of a measurement against its simulation |
//! | `synchronisation` | the shift of a section, estimated from its signals |

mod common;
pub mod margins;
mod one_record;
pub mod print;
pub mod row;
pub mod section_values;
pub mod shifts;
mod sides;
pub mod synchronisation;

pub use common::Meetings;
pub use one_record::{one_record, read_record};
pub use print::Print;
pub use row::Row;
pub use section_values::SectionValues;
pub use shifts::{Offset, Shifts};
pub use sides::{NodeValues, Original, RecordOfSide, Sides, Two};
