//! Simulators: what turns a section and settings of parameters into a record.

#![allow(clippy::cast_precision_loss)]

mod add;
mod builtin;
mod campaign;
mod compare;
mod external;
mod origin;
mod section;
mod write;

pub use add::{Plan, Simulated, check_confined, incremented, simulate};
pub use builtin::{Builtin, model_parameters, number_of, single};
pub use campaign::{Units, in_units, read_signals, record_text, recorded};
pub use compare::{Deviation, baseline_warning, deviations};
pub use external::{Cache, External, Program, read_program};
pub use origin::{Made, effects_of_origin};
pub use section::{Fact, Section, sections};
pub use write::write_campaign;

use crate::effects::Signals;
use crate::problem::Problem;
use crate::units::Unit;

/// A record to be made.
#[derive(Clone, Copy, Debug)]
pub struct Task<'a> {
    pub section: &'a Section,
    /// Parameters of the simulator that differ from the vehicle file, in its units.
    pub settings: &'a [(String, f64)],
    /// Recorded minus true position in m: the record is made where it will be shifted to.
    pub shift: f64,
    /// Whether nothing but what lies inside the section is asked for; a simulator may make more.
    pub inside_only: bool,
}

/// Something that makes records.
pub trait Simulator: Sync {
    /// What reports call it.
    fn name(&self) -> &str;

    /// The name by which a catalogue says which parameters of it an effect moves; `None` for the built-in model.
    fn catalogue_name(&self) -> Option<&str>;

    /// The unit that it makes a channel in; `None`: that of the campaign's simulation.
    fn unit(&self, _channel: &str) -> Option<Unit> {
        None
    }

    /// Makes a record.
    ///
    /// # Errors
    /// What went wrong, and where: a run that diverges, a program that fails, an input that cannot be read.
    fn run(&self, task: &Task<'_>) -> Result<Signals, Problem>;
}
