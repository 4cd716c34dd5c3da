//! Simulators: from a section and parameter settings to a record.

#![allow(clippy::cast_precision_loss)]

mod add;
mod builtin;
mod campaign;
mod compare;
mod external;
mod function;
mod made;
mod origin;
mod section;
mod strict;
mod write;

pub use add::{Plan, check_confined, incremented, interpolated, simulate};
pub use builtin::{Builtin, model_parameters, number_of, single};
pub use campaign::{
    Units, columns, frame, in_units, record_file, recorded, recorded_inside, signals_of,
};
pub use compare::{Deviation, baseline_warning, deviations};
pub use external::{Cache, External, Program, read_program};
pub use function::{Call, Function};
pub use origin::{Made, effects_of_origin};
pub use section::{Fact, Section, sections};
pub use strict::Strict;
pub use write::{with_records, write_campaign};

use crate::effects::Signals;
use crate::problem::Problem;
use crate::units::Unit;

/// A record to be simulated.
#[derive(Clone, Copy, Debug)]
pub struct Task<'a> {
    pub section: &'a Section,
    /// Parameters of the simulator that differ from the vehicle file, in its units.
    pub settings: &'a [(String, f64)],
    /// Recorded minus true position in m: the record is extended by it.
    pub shift: f64,
    /// Whether only the part inside the section is needed; a simulator may give more.
    pub inside_only: bool,
}

/// A simulator.
pub trait Simulator: Sync {
    /// Name in reports.
    fn name(&self) -> &str;

    /// Name under which catalogues list its parameters; `None` for the built-in model.
    fn catalogue_name(&self) -> Option<&str>;

    /// Unit of a channel; `None`: that of the campaign's simulation.
    fn unit(&self, _channel: &str) -> Option<Unit> {
        None
    }

    /// Simulates a record.
    ///
    /// # Errors
    /// The run diverges, the program fails, or an input cannot be read; with its place.
    fn run(&self, task: &Task<'_>) -> Result<Signals, Problem>;
}
