//! What a protocol asks of the data: checks of sections, plausibility, copies.

pub mod causes;
pub mod checks;
pub mod consequence;
pub mod copies;
pub mod exchanged;
pub mod plausibility;

pub use checks::{record_checks, track_checks};
pub use plausibility::Questions;
