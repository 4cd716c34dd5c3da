//! `simulate`: runs the reference vehicle model or another simulator, with effects added.

use rayon::prelude::*;

use super::{
    kit::*,
    of_runs::WithFiles,
    simulator::{Chosen, SimulatorChoice, all},
};
use crate::effects::{self, Applied, Catalogue};
use crate::model::{
    CHANNELS,
    integrate::{MOST_STEPS, Method, SAMPLE, Steps},
};
pub use crate::prepare::load_catalogue;
use crate::simulate::{
    Deviation, Made, Plan, Section, check_confined, effects_of_origin, record_file, sections,
    simulate, single, write_campaign,
};
use crate::units::{Dimension, Unit, number};
use crate::yaml;

#[derive(Debug, Args)]
pub struct Simulate {
    /// Folder of a campaign; all its sections are simulated. Of runs, those are that the table of
    /// sections or the protocol gives.
    #[arg(required_unless_present = "vehicle", conflicts_with_all = ["vehicle", "track", "speed", "output"])]
    campaign: Option<PathBuf>,
    /// Vehicle file; its contact profile is in the same folder.
    #[arg(long, requires_all = ["track", "output"], conflicts_with = "simulator")]
    vehicle: Option<PathBuf>,
    /// Track file.
    #[arg(long)]
    track: Option<PathBuf>,
    /// Speed in m/s, or with its unit: `120 km/h`.
    #[arg(long, requires = "vehicle")]
    speed: Option<String>,
    /// Effect and its size; may be repeated: `friction=0.5`, `payload=3.5 t`, `sensor_gain=0.8 on
    /// Y_3R`, `friction=0.2 in zones 3, 4`; `fishplate effects` lists them.
    #[arg(long = "effect", value_name = "EFFECT[.PARAMETER]=VALUE")]
    effects: Vec<String>,
    /// Catalogue of effects: a path, or the name of a shipped one.
    #[arg(long = "effects", value_name = "CATALOGUE", default_value = library::CATALOGUES[0].name)]
    catalogue: String,
    /// Protocol that finds the sections in the runs of a campaign: a path, or the name of a shipped
    /// one [default: the one in campaign.yaml]
    #[arg(long, short, conflicts_with = "vehicle")]
    protocol: Option<String>,
    /// Output folder for the simulated campaign; created if missing.
    #[arg(long, required_unless_present = "vehicle")]
    out: Option<PathBuf>,
    #[command(flatten)]
    simulator: SimulatorChoice,
    /// Method of integration of the reference vehicle model.
    #[arg(long, value_enum, default_value_t, conflicts_with = "simulator")]
    integrator: Integrator,
    /// Largest step of integration of the reference vehicle model, in ms or with its unit: `0.25
    /// ms`. At low speed steps are shorter.
    #[arg(long, default_value = "1 ms", conflicts_with = "simulator")]
    step: String,
    /// Add effects to the campaign's own simulation: its records + (simulator with effects -
    /// simulator without).
    #[arg(long, requires = "campaign")]
    increment: bool,
    /// Compare the simulator without effects with the campaign's simulation first, and print the
    /// deviation.
    #[arg(long, requires = "campaign")]
    baseline: bool,
    /// Format of the simulated records of a campaign.
    #[arg(long, value_enum, default_value_t, conflicts_with = "output")]
    records: Records,
    /// Output file for the record: Parquet if its name ends in `.parquet`, else CSV.
    #[arg(long, short)]
    output: Option<PathBuf>,
    /// Number of sections processed in parallel [default: one per core]
    #[arg(long, short, value_parser = from_one)]
    jobs: Option<NonZeroUsize>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Integrator {
    /// The classical method of fourth order.
    #[default]
    RungeKutta,
    /// The midpoint method of second order, for comparisons.
    Midpoint,
}
impl Simulate {
    pub fn run(self, console: &Console) -> Done {
        start_jobs(self.jobs)?;
        let catalogue = console.read(|problems| load_catalogue(&self.catalogue, problems))?;
        let effects = effects::choose(&catalogue, &self.effects).map_err(Problems)?;
        let steps = steps(self.integrator, &self.step)?;
        match (&self.campaign, &self.vehicle) {
            (Some(campaign), _) => self.whole(campaign, (&catalogue, &effects), steps, console),
            (None, Some(vehicle)) => {
                self.of_vehicle(vehicle, (&catalogue, &effects), steps, console)
            }
            (None, None) => Ok(Exit::Wrong),
        }
    }

    /// Simulates every section of a campaign, and writes a campaign with the simulated records.
    fn whole(
        &self,
        folder: &Path,
        (catalogue, effects): (&Catalogue, &[Applied]),
        steps: Steps,
        console: &Console,
    ) -> Done {
        let mut problems = Problems::default();
        let places = |campaign: &Campaign| {
            self.out.as_ref().map_or(Ok(()), |out| check_folder(out, CAMPAIGN, campaign))
        };
        let files = WithFiles::open(folder, self.protocol.as_deref(), &places, &mut problems);
        let prepared = files.as_ref().map(|files| &files.campaign).and_then(|campaign| {
            if self.increment || self.baseline {
                problems.value(campaign.only_one(RecordKind::Simulation))?;
            }
            problems.value(campaign.one_vehicle())?;
            let sections = sections(campaign, &mut problems)?;
            let chosen = self.simulator.open(campaign, &mut problems)?.integrated(steps);
            problems.value(chosen.check(catalogue))?;
            problems.add(unusable(catalogue, effects, &sections, &chosen));
            Some((campaign, chosen, sections))
        });
        let (campaign, chosen, sections) = console.sound(prepared, &problems)?;
        let Some(out) = &self.out else { return Ok(Exit::Wrong) };
        if self.baseline {
            let (deviations, warning) = chosen
                .baseline(campaign, &sections)
                .map_err(|failed| Ended::unfinished(Problems(failed)))?;
            say_baseline(console, &chosen, &deviations);
            console.problems(&Problems(warning.into_iter().collect()));
        }
        let format = Format::from(self.records);
        let of = (catalogue, effects);
        let made = console.with_progress(sections.len(), |progress| {
            let one = |section: &Section| {
                let file = self.record(format, &chosen, campaign, of, section);
                progress(section.name());
                file
            };
            all(sections.par_iter().map(one).collect())
        });
        let made = made.map_err(|failed| Ended::unfinished(Problems(failed)))?;
        let records = sections.iter().map(Section::name).zip(made);
        let made = Made {
            command: "simulate",
            simulator: Some(chosen.simulator().name()),
            effects: effects_of_origin(effects, catalogue),
            added: self.increment,
            fitted: false,
        };
        console.problems(&Problems(chosen.warning().into_iter().collect()));
        let mut outputs = Outputs::of(SetKind::Campaign, out);
        let added = write_campaign(&mut outputs, campaign, (format, records), Some(&made));
        console.commit(added.map(|()| outputs))?;
        console.say(&format!(
            "written: {} sections to {}{}",
            sections.len(),
            out.display(),
            chosen.effort()
        ));
        Ok(Exit::Done)
    }

    /// The file of a section's record.
    fn record(
        &self,
        format: Format,
        chosen: &Chosen<'_>,
        campaign: &Campaign,
        (catalogue, effects): (&Catalogue, &[Applied]),
        section: &Section,
    ) -> Result<Vec<u8>, Problem> {
        if !self.increment {
            let made = simulate(chosen.simulator(), catalogue, effects, section, None)?;
            return record_file(format, &made, &|channel| chosen.unit(section, channel));
        }
        let (recorded, units) = chosen.recorded(campaign, section)?;
        let made = simulate(chosen.simulator(), catalogue, effects, section, Some(&recorded))?;
        record_file(format, &made, &|channel| Unit::of(channel, &units))
    }

    /// Simulates one vehicle on one track.
    fn of_vehicle(
        &self,
        vehicle: &Path,
        (catalogue, effects): (&Catalogue, &[Applied]),
        steps: Steps,
        console: &Console,
    ) -> Done {
        let (Some(track), Some(output)) = (&self.track, &self.output) else {
            return Ok(Exit::Wrong);
        };
        check_file(output, &[vehicle, track])?;
        let (tree, speed) = console.read(|problems| {
            let tree = problems
                .value(read_text(vehicle, &vehicle.display().to_string()))
                .and_then(|(source, _)| yaml::load(&source, problems));
            tree.zip(problems.value(speed(self.speed.as_deref())))
        })?;
        let nowhere = Section::nowhere();
        if let Some(confined) = effects.iter().find(|applied| applied.confined.is_some()) {
            let says = format!(
                "`{}` is confined to some sections, but only one record is simulated",
                confined.effect
            );
            return Err(Problem::error("no-such-section", says).into());
        }
        let plan = Plan::new(catalogue, effects, &nowhere, None)?;
        let made = single((vehicle, &tree), track, speed, (&plan.settings, plan.shift()), steps);
        let mut signals = made.map_err(|problems| {
            let failed = problems.0.iter().any(|problem| problem.code == "simulation-failed");
            Ended { problems, exit: if failed { Exit::Unfinished } else { Exit::Wrong } }
        })?;
        plan.operate(&mut signals, &nowhere)?;
        console.write(output, &record_file(Format::of(output), &signals, &unit)?)
    }
}

/// Problems of effects with these sections, independent of the simulator.
fn unusable(
    catalogue: &Catalogue,
    effects: &[Applied],
    sections: &[Section],
    chosen: &Chosen<'_>,
) -> Vec<Problem> {
    let mut problems = check_confined(effects, sections);
    let simulator = chosen.simulator().catalogue_name();
    for section in sections {
        match Plan::new(catalogue, effects, section, simulator) {
            Err(problem) => problems.push(problem),
            Ok(plan) if !plan.formulas.is_empty() => {
                let differs = |(channel, unit): &&(String, Unit)| {
                    let found = chosen.unit(section, channel);
                    found.dimension == unit.dimension && found.factor != unit.factor
                };
                problems.extend(catalogue.units.iter().find(differs).map(|(channel, unit)| {
                    let says = format!(
                        "`{channel}` is recorded in {}, but the catalogue expects {unit}",
                        chosen.unit(section, channel)
                    );
                    Problem::error("unit-mismatch", says)
                        .help("set `units` in the catalogue to those of the records")
                }));
            }
            Ok(_) => {}
        }
    }
    problems
}

fn say_baseline(console: &Console, chosen: &Chosen<'_>, deviations: &[Deviation]) {
    let largest = deviations.iter().max_by(|a, b| a.share().total_cmp(&b.share()));
    if let Some(worst) = largest {
        console.say(&format!(
            "baseline: {} deviates from the campaign's simulation by at most {:.2} % (`{}` of section `{}`)",
            chosen.simulator().name(),
            100.0 * worst.share(),
            worst.channel,
            worst.section
        ));
    }
}

/// The unit of a channel of the model.
fn unit(name: &str) -> Unit {
    let known = CHANNELS.iter().find(|(known, _)| *known == name);
    known.and_then(|(_, unit)| Unit::parse(unit).ok()).unwrap_or_else(Unit::one)
}

/// The steps of a method. A sample is a whole number of them.
fn steps(integrator: Integrator, written: &str) -> Result<Steps, Problem> {
    let wrong = |says: String| {
        Problem::error("step", says).help("write `--step 0.5` for ms, or `--step '0.5 ms'`")
    };
    let milliseconds = Unit { text: "ms".into(), factor: SAMPLE, dimension: Dimension::TIME };
    let step = number::read(written, &milliseconds).map_err(|refused| wrong(refused.says))?.si;
    let parts = SAMPLE / step;
    if !(1.0 - 1e-9..=MOST_STEPS + 1e-9 * MOST_STEPS).contains(&parts) {
        let least = 1.0 / MOST_STEPS;
        return Err(wrong(format!(
            "a step of {} ms is outside the range of the model, {least} to 1 ms",
            step / SAMPLE
        )));
    }
    let method = match integrator {
        Integrator::RungeKutta => Method::RungeKutta,
        Integrator::Midpoint => Method::Midpoint,
    };
    // No longer than asked for; of 0.2 ms, which is no binary fraction, there are five.
    Ok(Steps { method, per_sample: (parts - 1e-9).ceil() as usize })
}

fn speed(written: Option<&str>) -> Result<f64, Problem> {
    let wrong = |code, says: &str| {
        Problem::error(code, says).help("write `--speed 30` for m/s, or `--speed '108 km/h'`")
    };
    let written = written.ok_or_else(|| wrong("speed-missing", "no speed is given"))?;
    let unit =
        Unit { text: "m/s".into(), factor: 1.0, dimension: Dimension::LENGTH / Dimension::TIME };
    let speed = number::read(written, &unit).map_err(|refused| wrong("speed", &refused.says))?.si;
    if !(1.0..=150.0).contains(&speed) {
        let says =
            format!("a speed of {speed:.1} m/s is outside the range of the model, 1 to 150 m/s");
        return Err(wrong("speed", &says));
    }
    Ok(speed)
}
