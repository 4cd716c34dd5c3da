//! What a protocol asks of the data: checks of sections, plausibility, copies; and what follows where
//! something is not met.
//!
//! | file | content |
//! |---|---|
//! | `causes` | the probable cause of a wrong value; what one finding explains of others |
//! | `plausibility` | plausibility rules in one section |
//! | `checks` | checks of a section on its records |
//! | `changed` | records that are not as an import wrote them |
//! | `over_sections` | requirements that all sections meet together |
//! | `matching` | records and channels that belong together, by their shapes in all sections |
//! | `copies` | signals that are copies, in all sections |
//! | `consequence` | sections that are not used, for what was found; faults that end a run |

pub mod causes;
pub mod changed;
mod checks;
pub mod consequence;
pub mod copies;
pub mod matching;
pub mod over_sections;
pub mod plausibility;

pub use checks::{record_checks, track_checks};
pub use consequence::{nothing_usable, stop_on_fault, take_over};
pub use plausibility::Questions;
