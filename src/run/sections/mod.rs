//! The sections of the campaigns, and what is known of them before any record is read.

pub mod columns;
pub mod facts;
pub mod requirements;
pub mod stretches;
pub mod unit;
pub mod units;
pub mod wanted;

pub use facts::{
    Facts, Known, NOT_STATED, Vehicle, absent, is_dimensioned, scalar, trimmed, vehicle_item,
};
pub use requirements::sections_in_words;
pub use unit::Unit;
pub use units::{STATE, of_run};
pub use wanted::{Point, columns, value, word};
