//! The values of one section: from the nodes of its records to rows.

pub mod common;
pub mod margins;
pub mod one_record;
pub mod print;
pub mod section_values;
pub mod sides;
pub mod synchronisation;

pub use common::Meetings;
pub use margins::{note_margins, slow};
pub use one_record::one_record;
pub use print::Print;
pub use section_values::SectionValues;
pub use sides::{Evaluated, Original, RecordOfSide, Sides, Two, number_of, samples_of, section};
pub use synchronisation::Shifts;
