//! The sections of the campaigns, and what is known of them before any record is read.
//!
//! | file | content |
//! |---|---|
//! | `unit` | a section as it is evaluated |
//! | `facts` | vehicle data, and values of names in expressions |
//! | `needed` | the nodes that a section needs |
//! | `units` | the sections of all campaigns |
//! | `wanted` | the table of wanted operation |
//! | `columns` | which positions were recorded |
//! | `stretches` | parts of runs that sections share |
//! | `requirements` | what is required of the data of a section |
//! | `basis` | all of this together |

pub mod basis;
pub mod columns;
mod facts;
mod needed;
pub mod requirements;
pub mod stretches;
mod unit;
pub mod units;
pub mod wanted;

pub use basis::Basis;
pub use facts::{
    Facts, Known, NOT_STATED, Vehicle, absent, is_dimensioned, scalar, trimmed, vehicle_item,
};
pub use needed::{chosen, needed};
pub use unit::{Extent, Stretch, Unit};
pub use units::of_run;
