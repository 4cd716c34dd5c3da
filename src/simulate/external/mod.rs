//! A program as a simulator: one call simulates one record.

mod cache;
mod content;
mod function;
mod process;
mod python;
mod read;
mod started;
mod words;

use std::{
    path::{Path, PathBuf},
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering},
    },
};

pub use cache::Cache;
pub use read::{Program, read_program};

use super::{
    Section, Simulator, Task,
    campaign::{Units, recorded},
    compare::{Deviation, deviations},
    made::{first, read_made, unit_in},
};
use crate::data::{
    Campaign, CampaignPath, Heading, RecordKind, record::RecordSource, text::LARGEST_RECORD,
};
use crate::disk;
use crate::effects::Signals;
use crate::problem::{Problem, error};
use crate::source::Source;
use crate::units::Unit;
use cache::Key;
use content::{absolute, basis, vehicle_file};
use process::{Call, Fault};
use python::Workers;
use words::{Hole, fill};

/// A program with the vehicle and the tracks of a campaign.
#[derive(Debug)]
pub struct External<'a> {
    campaign: &'a Campaign,
    program: Program,
    cache: Cache,
    /// Path of the vehicle file, if the campaign names one.
    vehicle: Option<PathBuf>,
    /// The processes of a Python function.
    workers: Option<Workers>,
    /// Common inputs of all its records.
    basis: Key,
    /// Units of channels that are not in the campaign, by section.
    units: Mutex<Vec<(String, Units)>>,
    calls: AtomicUsize,
    found: AtomicUsize,
}

impl<'a> External<'a> {
    /// The program for a campaign.
    ///
    /// # Errors
    /// The campaign lacks a file that the command needs: `key-missing`, `file-unreadable`.
    pub fn new(campaign: &'a Campaign, program: Program, cache: Cache) -> Result<Self, Problem> {
        let lacks = |key: &str| {
            let says = format!(
                "the campaign has no `{key}`, which the command of `{}` needs",
                program.name
            );
            error("key-missing", says, &campaign.tree.span.part(0..0)).also(&program.span, "here")
        };
        if program.asks(Hole::Track) && !campaign.has(RecordKind::Track) {
            return Err(lacks("track"));
        }
        let vehicle = vehicle_file(campaign)?;
        if program.asks(Hole::Vehicle) && vehicle.is_none() {
            return Err(lacks("vehicle"));
        }
        let basis = basis(campaign, &program, vehicle.as_deref())?;
        let (calls, found, units) = (AtomicUsize::new(0), AtomicUsize::new(0), Mutex::default());
        let workers = program.python.clone().map(|python| Workers::new(python, &program));
        Ok(Self { campaign, program, cache, vehicle, workers, basis, units, calls, found })
    }

    /// Description of the program.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// Number of calls of the program, and of records from the cache.
    pub fn effort(&self) -> (usize, usize) {
        (self.calls.load(Ordering::Relaxed), self.found.load(Ordering::Relaxed))
    }

    /// The unit of a channel of a section's record: that of the campaign's simulation, else that of
    /// the program's last record.
    pub fn unit(&self, section: &Section, channel: &str) -> Unit {
        let own = || {
            let units = self.units.lock().ok()?;
            let (_, units) = units.iter().find(|(name, _)| name == section.name())?;
            Some(units.iter().find(|(name, _)| name == channel)?.1.clone())
        };
        unit_in(&self.headings(section), channel).or_else(own).unwrap_or_else(Unit::one)
    }

    /// Deviation of the program without effects from the campaign's simulation of a section, by
    /// channel.
    ///
    /// # Errors
    /// Of the program; the campaign's record cannot be read; the records do not overlap.
    pub fn baseline(&self, section: &Section) -> Result<Vec<Deviation>, Problem> {
        let (recorded, ..) =
            recorded(self.campaign, RecordKind::Simulation, section).map_err(first)?;
        deviations(
            &self.run(&Task { section, settings: &[], shift: 0.0, inside_only: false })?,
            &recorded,
            section,
        )
    }

    /// Headings of the campaign's simulation of a section; empty if there is none.
    fn headings(&self, section: &Section) -> Vec<Heading> {
        let source = self.campaign.record_source(RecordKind::Simulation, &section.cell);
        source.ok().and_then(|source| source.headings().ok()).unwrap_or_default()
    }

    /// The words of a call with all placeholders replaced.
    fn filled(&self, task: &Task<'_>, out: &Path) -> Result<Vec<String>, Problem> {
        let section = task.section;
        let asks = |hole: Hole| self.program.asks(hole);
        let lacks = |what: &str| {
            let says = format!(
                "section `{}` has no {what}, which the command of `{}` needs",
                section.name(),
                self.program.name
            );
            error("section", says, &section.cell.span)
        };
        if self.workers.is_none() && !task.settings.is_empty() && !asks(Hole::Set) {
            let says = format!(
                "`{}` accepts no parameters: its command has no `{{set}}`",
                self.program.name
            );
            return Err(error("not-simulated", says, &self.program.span));
        }
        if asks(Hole::Speed) && section.speed.is_none() {
            return Err(lacks("speed"));
        }
        if (asks(Hole::Start) || asks(Hole::End))
            && !(section.start.is_finite() && section.end.is_finite())
        {
            return Err(lacks("start or no end"));
        }
        let track = if asks(Hole::Track) { Some(self.track(section)?) } else { None };
        let path =
            |path: Option<&Path>| path.map(|path| path.display().to_string()).unwrap_or_default();
        let fills = |hole: Hole| match hole {
            Hole::Vehicle => path(self.vehicle.as_deref()),
            Hole::Track => path(track.as_deref()),
            Hole::Out => path(Some(out)),
            Hole::Speed => section
                .speed
                .map(|speed| self.program.speed_unit.from_si(speed).to_string())
                .unwrap_or_default(),
            Hole::Section => section.name().to_string(),
            Hole::Start => (section.start - task.shift).to_string(),
            Hole::End => (section.end - task.shift).to_string(),
            Hole::Set | Hole::Name | Hole::Value => String::new(),
        };
        Ok(fill(&self.program.command, &self.program.set, task.settings, &fills))
    }

    fn track(&self, section: &Section) -> Result<PathBuf, Problem> {
        let place = self.campaign.record_place(RecordKind::Track, &section.cell)?;
        Ok(absolute(&place.path))
    }

    /// The cache key of a record. It depends on the contents of files, not on their paths.
    fn key(&self, task: &Task<'_>) -> Result<String, Problem> {
        let mut key = self.basis.clone();
        let asks = |hole: Hole| self.program.asks(hole);
        if asks(Hole::Track) {
            key.add_file("track", &self.track(task.section)?)?;
        }
        if asks(Hole::Section) {
            key.add("section", task.section.name());
        }
        if let (true, Some(speed)) = (asks(Hole::Speed), task.section.speed) {
            key.add("speed", &speed.to_string());
        }
        if asks(Hole::Start) || asks(Hole::End) {
            key.add("start", &(task.section.start - task.shift).to_string());
            key.add("end", &(task.section.end - task.shift).to_string());
        }
        if self.workers.is_some() {
            self.add_inputs(&mut key, task.section)?;
        }
        for (name, value) in task.settings {
            key.add("name", name);
            key.add("value", &value.to_string());
        }
        Ok(key.finish())
    }

    /// Reads and checks a record, in the units of the campaign's simulation.
    fn read(&self, path: &Path, section: &Section) -> Result<Signals, Problem> {
        let shown = format!("{}.csv of {}", section.name(), self.program.name);
        let known = self.headings(section);
        let made = RecordSource::File(CampaignPath {
            path: path.to_path_buf(),
            shown: shown.clone(),
            inside: shown,
        });
        let (signals, units) = read_made(&made, &known, &self.program.channels)?;
        covers(&signals.axis, section)?;
        if let Ok(mut all) = self.units.lock() {
            all.retain(|(name, _)| name != section.name());
            all.push((section.name().to_string(), units));
        }
        Ok(signals)
    }

    /// Reads a record from the cache.
    fn read_kept(&self, bytes: &[u8], section: &Section) -> Result<Signals, Problem> {
        let folder = disk::scratch().map_err(no_folder)?;
        let file = folder.path().join("record.csv");
        crate::data::write::keep(&file, bytes)?;
        self.read(&file, section)
    }

    /// A warning of damaged cache entries.
    pub fn warning(&self) -> Option<Problem> {
        self.cache.warning()
    }

    /// Calls the program once; returns the record and its text.
    fn call(&self, task: &Task<'_>) -> Result<(Signals, Vec<u8>), Problem> {
        if let Some(workers) = &self.workers {
            self.calls.fetch_add(1, Ordering::Relaxed);
            return self.ask(workers, task);
        }
        let section = task.section;
        // A record that another machine writes must lie where both see it.
        let folder =
            if self.program.launch.is_empty() { disk::scratch() } else { self.cache.scratch() };
        let folder = folder.map_err(no_folder)?;
        let out = folder.path().join("record.csv");
        let words = self.filled(task, &out)?;
        let executable = self.program.executable();
        let call = Call {
            launch: &self.program.launch,
            program: &executable,
            arguments: words.get(1..).unwrap_or_default(),
            environment: &self.program.environment,
            folder: &self.program.folder,
            timeout: self.program.timeout,
        };
        self.calls.fetch_add(1, Ordering::Relaxed);
        let command = || format!("the command was: {}", words.join(" "));
        process::run(&call).map_err(|fault| self.told(&fault, Some(section)).help(command()))?;
        if !disk::may_be_file(&out) {
            let says = format!("{} ended without an error, but wrote no record", self.program.name);
            let problem = error("simulator-output", says, &section.cell.span);
            let problem = section.named(problem);
            return Err(problem.help(command()));
        }
        let signals = self.read(&out, section).map_err(|problem| {
            let says = format!("the record of {}: {}", self.program.name, problem.says);
            let help = problem.help.clone().unwrap_or_else(command);
            section.named(Problem { says, ..problem }).help(help)
        })?;
        let bytes = disk::read(&out, LARGEST_RECORD).map_err(|error| {
            Problem::error("file-unreadable", format!("the record cannot be read: {error}"))
        })?;
        Ok((signals, bytes))
    }

    /// Why a call failed.
    fn told(&self, fault: &Fault, section: Option<&Section>) -> Problem {
        let name = &self.program.name;
        let last_output = "its last output";
        let (code, how, said, what) = match fault {
            Fault::NotStarted(error) => {
                ("simulator-failed", self.program.not_started(error), "", last_output)
            }
            Fault::TimedOut { said } => {
                let seconds = self.program.timeout.as_secs_f64();
                let how = format!("was terminated after {seconds} s, its time-out");
                ("simulator-timeout", how, said.as_str(), last_output)
            }
            Fault::Failed { status, said } => {
                ("simulator-failed", format!("failed: {status}"), said.as_str(), last_output)
            }
            Fault::Ended { said } => {
                ("simulator-failed", "ended during a call".into(), said.as_str(), last_output)
            }
            Fault::Raised(error) => {
                let last = error.lines().last().unwrap_or_default();
                ("simulator-failed", format!("failed: {last}"), error.as_str(), "its error")
            }
            Fault::Answer(says) => {
                let how = format!("gave an answer that cannot be read: {says}");
                ("simulator-output", how, "", last_output)
            }
        };
        let at = section.map_or(&self.program.span, |section| &section.cell.span);
        let problem = error(code, format!("{name} {how}"), at);
        let problem = match section {
            Some(section) => section.named(problem),
            None => problem,
        };
        if said.is_empty() {
            problem
        } else {
            problem.also(&Source::new(name.as_str(), said).whole(), what)
        }
    }
}

fn no_folder(error: std::io::Error) -> Problem {
    Problem::error("write-failed", format!("no temporary folder can be created: {error}"))
}

/// The record of a simulator must have the whole section, up to one sample.
fn covers(axis: &[f64], section: &Section) -> Result<(), Problem> {
    let ([first, second, ..], Some(last)) = (axis, axis.last()) else { return Ok(()) };
    let slack = second - first;
    if first - slack <= section.start && section.end <= last + slack
        || !(section.start.is_finite() && section.end.is_finite())
    {
        return Ok(());
    }
    let says = format!(
        "it goes from {first:.3} to {last:.3}, and the section from {:.3} to {:.3}",
        section.start, section.end
    );
    Err(Problem::error("simulator-output", says)
        .help("the record must cover the section, on the same axis"))
}

impl Simulator for External<'_> {
    fn name(&self) -> &str {
        let Program { title, .. } = &self.program;
        title
    }

    fn catalogue_name(&self) -> Option<&str> {
        Some(&self.program.name)
    }

    fn run(&self, task: &Task<'_>) -> Result<Signals, Problem> {
        // Errors that a retry would not remove are reported first.
        self.filled(task, Path::new(""))?;
        let key = self.key(task)?;
        // A cached record that cannot be read is simulated again.
        if let Some(bytes) = self.cache.get(&key) {
            if let Ok(signals) = self.read_kept(&bytes, task.section) {
                self.found.fetch_add(1, Ordering::Relaxed);
                return Ok(signals);
            }
            self.cache.is_damaged(&key);
        }
        let mut tries = 0;
        loop {
            tries += 1;
            match self.call(task) {
                Ok((signals, bytes)) => {
                    self.cache.keep(&key, &bytes)?;
                    return Ok(signals);
                }
                Err(_) if tries <= self.program.retries => {}
                Err(problem) if tries == 1 => return Err(problem),
                Err(problem) => {
                    return Err(Problem {
                        says: format!("{} ({tries} tries)", problem.says),
                        ..problem
                    });
                }
            }
        }
    }
}
