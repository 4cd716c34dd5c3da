//! Choice of the simulator: the reference vehicle model, or a program described by a file.

use rayon::prelude::*;

use super::kit::*;
use crate::effects::{Catalogue, Signals};
use crate::model::integrate::Steps;
use crate::simulate::{
    Builtin, Cache, Deviation, External, Section, Simulator, Task, baseline_warning, deviations,
    in_units, read_program, recorded,
};
use crate::units::Unit;

/// Arguments that choose a simulator.
#[derive(Debug, Args)]
pub struct SimulatorChoice {
    /// File that describes another simulator, a program that is called once per record [default:
    /// the reference vehicle model]
    #[arg(long, value_name = "SIM.YAML")]
    simulator: Option<PathBuf>,
    /// Folder for records of another simulator, so that no call is repeated
    /// [default: fishplate-cache in the system's temporary folder]
    #[arg(long, value_name = "DIR", requires = "simulator")]
    cache: Option<PathBuf>,
    /// Neither store nor reuse records of another simulator.
    #[arg(long, requires = "simulator", conflicts_with = "cache")]
    no_cache: bool,
    /// Words before each call of another simulator that start it on another machine and wait for
    /// it, such as `srun -n1` [default: calls run here]. All machines see the folder of the cache
    #[arg(long, value_name = "WORDS", requires = "cache", allow_hyphen_values = true)]
    launch: Option<String>,
}

/// A simulator, ready for a campaign.
#[derive(Debug)]
pub enum Chosen<'a> {
    Builtin(Box<Builtin<'a>>),
    External(Box<External<'a>>),
}

/// All values, or all problems.
pub fn all<T>(found: Vec<Result<T, Problem>>) -> Result<Vec<T>, Vec<Problem>> {
    let (mut values, mut failed) = (Vec::new(), Vec::new());
    for one in found {
        match one {
            Ok(value) => values.push(value),
            Err(problem) => failed.push(problem),
        }
    }
    if failed.is_empty() { Ok(values) } else { Err(failed) }
}

/// Largest deviation of the reference vehicle model from the campaign's simulation without a
/// warning, as a share.
const TOLERANCE: f64 = 0.05;

impl SimulatorChoice {
    /// Whether another simulator is used.
    pub fn external(&self) -> bool {
        self.simulator.is_some()
    }

    /// The simulator for a campaign; `None`, with the reasons, if it cannot be used.
    pub fn open<'a>(&self, campaign: &'a Campaign, problems: &mut Problems) -> Option<Chosen<'a>> {
        let Some(file) = &self.simulator else {
            return Some(Chosen::Builtin(Box::new(Builtin::new(campaign, problems)?)));
        };
        let (source, _) = problems.value(read_text(file, &file.display().to_string()))?;
        let folder =
            file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut program = read_program(&source, folder, problems)?;
        let words = self.launch.iter().flat_map(|words| words.split_whitespace());
        program.launch = words.map(str::to_string).collect();
        if let Some(folder) = &self.cache {
            problems.value(check_folder(folder, &[], campaign))?;
        }
        let cache = match (&self.cache, self.no_cache) {
            (_, true) => Ok(Cache::none()),
            (Some(folder), _) => Cache::at(folder),
            (None, _) => Cache::temporary(),
        };
        let made = cache.and_then(|cache| External::new(campaign, program, cache));
        Some(Chosen::External(Box::new(problems.value(made)?)))
    }
}

impl Chosen<'_> {
    /// The reference vehicle model with other steps than its own; another simulator has its own.
    pub fn integrated(self, steps: Steps) -> Self {
        match self {
            Self::Builtin(model) if steps != Steps::from(1) => {
                Self::Builtin(Box::new(model.integrated(steps)))
            }
            same => same,
        }
    }

    pub fn is_external(&self) -> bool {
        matches!(self, Self::External(_))
    }

    pub fn simulator(&self) -> &dyn Simulator {
        match self {
            Self::Builtin(model) => &**model,
            Self::External(program) => &**program,
        }
    }

    /// The unit of a channel of a section's record.
    pub fn unit(&self, section: &Section, channel: &str) -> Unit {
        match self {
            Self::Builtin(model) => model.unit(channel).unwrap_or_else(Unit::one),
            Self::External(program) => program.unit(section, channel),
        }
    }

    /// The campaign's simulation of a section in the units of the simulator, with the unit of each
    /// channel.
    pub fn recorded(
        &self,
        campaign: &Campaign,
        section: &Section,
    ) -> Result<(Signals, Vec<(String, Unit)>), Problem> {
        let none = || Problem::error("unreadable", "the record cannot be read");
        let found = recorded(campaign, RecordKind::Simulation, section);
        let (mut signals, mut units, _) =
            found.map_err(|problems| problems.into_iter().next().unwrap_or_else(none))?;
        if let Self::Builtin(model) = self {
            in_units(&mut signals, &units, &|name| model.unit(name))?;
            units
                .iter_mut()
                .for_each(|(name, unit)| *unit = model.unit(name).unwrap_or_else(|| unit.clone()));
        }
        Ok((signals, units))
    }

    /// Compares the simulator without effects with the campaign's simulation: all deviations, and a
    /// warning if one is too large.
    pub fn baseline(
        &self,
        campaign: &Campaign,
        sections: &[Section],
    ) -> Result<(Vec<Deviation>, Option<Problem>), Vec<Problem>> {
        let one = |section: &Section| match self {
            Self::External(program) => program.baseline(section),
            Self::Builtin(model) => {
                let (recorded, _) = self.recorded(campaign, section)?;
                deviations(
                    &model.run(&Task { section, settings: &[], shift: 0.0, inside_only: false })?,
                    &recorded,
                    section,
                )
            }
        };
        let all = all(sections.par_iter().map(one).collect())?.concat();
        let tolerance = match self {
            Self::External(program) => program.program().tolerance,
            Self::Builtin(_) => TOLERANCE,
        };
        let warning = baseline_warning(self.simulator(), tolerance, &all);
        Ok((all, warning))
    }

    /// Checks that the parameters of a Python function and those of a catalogue agree.
    pub fn check(&self, catalogue: &Catalogue) -> Result<(), Vec<Problem>> {
        if let Self::External(program) = self { program.check(catalogue) } else { Ok(()) }
    }

    /// A warning of damaged records in the cache of a program.
    pub fn warning(&self) -> Option<Problem> {
        if let Self::External(program) = self { program.warning() } else { None }
    }

    /// Number of calls of the program: ` (3 calls of NAME, 13 records from the cache)`; empty for
    /// the model.
    pub fn effort(&self) -> String {
        let Self::External(program) = self else { return String::new() };
        let (calls, found) = program.effort();
        format!(" ({calls} calls of {}, {found} records from the cache)", program.program().name)
    }
}
