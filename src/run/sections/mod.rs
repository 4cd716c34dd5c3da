//! The sections of the campaigns, and what is known of them before any record is read.
//!
//! | file | content |
//! |---|---|
//! | `unit` | a section as it is evaluated, and parts of runs that sections share |
//! | `facts` | vehicle data, values of names in expressions, and the nodes that a section needs |
//! | `units` | the sections of all campaigns |
//! | `wanted` | the table of wanted operation |
//! | `columns` | which positions were recorded |
//! | `requirements` | what is required of the data of a section |
//! | `basis` | all of this together |

pub mod basis;
pub mod columns;
mod facts;
pub mod requirements;
mod unit;
pub mod units;
pub mod wanted;

pub use basis::Basis;
pub use facts::{
    Facts, Known, Limits, NOT_STATED, Vehicle, absent, chosen, is_dimensioned, needed, scalar,
    trimmed, vehicle_item,
};
pub use unit::{Extent, Stretch, Unit, share_stretches};
pub use units::{computed_of_runs, of_run};
