//! The reference vehicle model as a simulator for the sections of a campaign.

use std::path::Path;

use super::{Simulator, Task, made::first};
use crate::data::{
    Campaign, RecordKind,
    record::{Record, Wanted, read_record},
    table::Cell,
};
use crate::disk;
use crate::effects::{Channel, Signals};
use crate::model::{
    self, CHANNELS, PARAMETERS, Parameter, Profile, ProfileTable, SAMPLING_RATE, Setup, TrackTable,
    Vehicle, VehicleFault, Window, integrate::Steps,
};
use crate::problem::{Problem, Problems, error};
use crate::source::{Source, Spanned};
use crate::units::{
    Dimension, Unit,
    number::{self, Refused},
};
use crate::yaml::Node;

/// Sides of a wheelset in the vehicle file.
const SIDES: [(&str, f64); 3] = [("both", 0.0), ("R", 1.0), ("L", -1.0)];

/// Keys and units of the parameters of the model, for catalogues.
pub fn model_parameters() -> Vec<(&'static str, &'static str)> {
    PARAMETERS.iter().map(|parameter| (parameter.key, parameter.unit)).collect()
}

/// The model with the vehicle, the profile and the tracks of a campaign.
#[derive(Debug)]
pub struct Builtin<'a> {
    campaign: &'a Campaign,
    machine: Machine,
    steps: Steps,
    name: String,
}

/// A vehicle with its profiles.
#[derive(Debug)]
struct Machine {
    vehicle: Vehicle,
    new: ProfileTable,
    worn: Option<ProfileTable>,
}

/// Name of the model in reports.
const MODEL: &str = "reference vehicle model";

impl<'a> Builtin<'a> {
    /// Whether a campaign is of a vehicle that the model can describe: its vehicle file has a
    /// parameter of the model.
    pub fn is_for(campaign: &Campaign) -> bool {
        PARAMETERS.iter().any(|parameter| campaign.vehicle.lookup(parameter.key).is_some())
    }

    /// The model for a campaign; `None`, with problems, if the campaign lacks an input.
    pub fn new(campaign: &'a Campaign, problems: &mut Problems) -> Option<Self> {
        let vehicle = vehicle(&campaign.vehicle, problems)?;
        if !campaign.has(RecordKind::Track) {
            let says =
                "the campaign has no `track`, the folder of track files that the model needs";
            let problem = error("key-missing", says, &campaign.tree.span.part(0..0));
            problems.push(misspelt(problem, &campaign.tree, "track"));
            return None;
        }
        let place = |key: &str, default: &str| {
            let node = campaign.vehicle.lookup(key);
            let written = node.and_then(|node| {
                Some(Spanned::new(node.scalar_text()?.to_string(), node.span.clone()))
            });
            campaign.place(&written.unwrap_or_else(|| {
                Spanned::new(default.to_string(), campaign.tree.span.part(0..0))
            }))
        };
        let read = |key: &str, default: &str, needed: bool, problems: &mut Problems| match place(
            key, default,
        ) {
            Ok(place) if needed || disk::may_be_file(&place.path) => {
                profile(&place.path, &place.shown, problems)
            }
            Ok(_) => None,
            Err(problem) => {
                problems.push(problem);
                None
            }
        };
        let new = read("profile.file", "profile.csv", true, problems)?;
        let worn = read("profile.worn_file", "profile_worn.csv", false, problems);
        let machine = Machine { vehicle, new, worn };
        Some(Self { campaign, machine, steps: 1.into(), name: MODEL.into() })
    }

    /// The same with another method or step, which its name then says.
    pub fn integrated(self, steps: Steps) -> Self {
        let step = 1.0 / steps.per_sample as f64;
        Self {
            steps,
            name: format!("{MODEL}, {} with steps of {step} ms or less", steps.method.in_words()),
            ..self
        }
    }
}

impl Machine {
    /// The vehicle with some parameters set.
    fn with(&self, settings: &[(String, f64)]) -> Result<(Vehicle, Profile), Problem> {
        let mut vehicle = self.vehicle.clone();
        for (key, value) in settings {
            vehicle.set(key, *value).map_err(|fault| match fault {
                Some(fault) => inadmissible(&fault),
                None => Problem::error(
                    "unknown-parameter",
                    format!("the model has no parameter `{key}`"),
                )
                .suggest(key, PARAMETERS.iter().map(|parameter| parameter.key)),
            })?;
        }
        let profile = Profile::new(&self.new, self.worn.as_ref(), &vehicle).ok_or_else(|| {
            Problem::error(
                "profile",
                "a worn profile needs a second profile table over the same displacements",
            )
            .help("put `profile_worn.csv` into the folder of `profile.csv`")
        })?;
        Ok((vehicle, profile))
    }
}

impl Simulator for Builtin<'_> {
    fn name(&self) -> &str {
        &self.name
    }

    fn catalogue_name(&self) -> Option<&str> {
        None
    }

    fn unit(&self, channel: &str) -> Option<Unit> {
        let (_, unit) = CHANNELS.iter().find(|(name, _)| *name == channel)?;
        Unit::parse(unit).ok()
    }

    fn run(&self, task: &Task<'_>) -> Result<Signals, Problem> {
        let section = task.section;
        let Some(speed) = section.speed else {
            return Err(error(
                "speed-missing",
                format!("section `{}` has no speed", section.name()),
                &section.cell.span,
            ));
        };
        let (vehicle, profile) = self.machine.with(task.settings)?;
        let track = track_of(self.campaign, &section.cell)?;
        let mut around = Window::around(section.start, section.end);
        if task.inside_only {
            around.to = section.end;
        }
        let window = Window { from: around.from - task.shift, to: around.to - task.shift };
        let setup = Setup { vehicle: &vehicle, profile: &profile, track: &track, speed };
        made(&setup, window, self.steps).map_err(|problem| section.named(problem))
    }
}

fn made(setup: &Setup<'_>, window: Window, steps: Steps) -> Result<Signals, Problem> {
    let record = model::simulate(setup, window, steps)
        .map_err(|failure| Problem::error("simulation-failed", failure.to_string()))?;
    let channels = CHANNELS
        .iter()
        .zip(record.channels)
        .map(|((name, _), values)| Channel { name: (*name).to_string(), values });
    Ok(Signals {
        axis: record.distance,
        over_time: false,
        rate: SAMPLING_RATE,
        channels: channels.collect(),
    })
}

/// The vehicle of a vehicle file. Numbers may have a unit; otherwise that of the parameter is
/// assumed.
pub fn vehicle(tree: &Node, problems: &mut Problems) -> Option<Vehicle> {
    let before = problems.errors();
    let mut values: Vec<(&str, f64)> = Vec::new();
    for parameter in PARAMETERS {
        let Some(node) = tree.lookup(parameter.key) else { continue };
        let Some(text) = node.scalar_text() else { continue };
        let side = SIDES.iter().find(|(word, _)| *word == text).map(|(_, side)| *side);
        let number = side.or_else(|| node.number());
        match number.map_or_else(|| stated(parameter, text), Ok) {
            Ok(number) => values.push((parameter.key, number)),
            Err(refused) => {
                let says = format!("`{}` ({}): {}", parameter.key, parameter.meaning, refused.says);
                let problem = error("wrong-kind", says, &node.span);
                problems.push(problem.help_if(refused.help));
            }
        }
    }
    if problems.errors() > before {
        return None;
    }
    let number =
        |key: &str| values.iter().find(|(known, _)| *known == key).map(|(_, value)| *value);
    match Vehicle::from_values(number) {
        Ok(vehicle) => Some(vehicle),
        Err(faults) => {
            for fault in faults {
                let (VehicleFault::Missing(parameter) | VehicleFault::Inadmissible(parameter, _)) =
                    &fault;
                let key = parameter.key;
                problems.push(match (&fault, tree.lookup(key)) {
                    (VehicleFault::Missing(_), Some(node)) => {
                        let what = format!("`{key}` ({})", parameter.meaning);
                        node.is_not(&what, &format!("a number in {}", parameter.unit))
                    }
                    (VehicleFault::Missing(_), None) => {
                        let problem = inadmissible(&fault).at(&tree.span.part(0..0));
                        misspelt(problem, tree, key)
                    }
                    (VehicleFault::Inadmissible(..), node) => {
                        let top = tree.span.part(0..0);
                        inadmissible(&fault).at(node.map_or(&top, |node| &node.span))
                    }
                });
            }
            None
        }
    }
}

/// A number of a vehicle file in the unit of the parameter with this key; for an unknown key,
/// without unit.
pub fn number_of(node: &Node, key: &str) -> Option<f64> {
    node.number().or_else(|| stated(model::parameter(key)?, node.scalar_text()?).ok())
}

/// Converts a text to a number in the unit of a parameter.
fn stated(parameter: &Parameter, text: &str) -> Result<f64, Refused> {
    let unit = Unit::parse(parameter.unit).unwrap_or_else(|_| Unit::one());
    number::read(text, &unit).map(|read| unit.from_si(read.si))
}

/// Shows a similar unknown key in place of a missing one.
fn misspelt(problem: Problem, tree: &Node, key: &str) -> Problem {
    let (group, name) = key.rsplit_once('.').unwrap_or(("", key));
    let beside = if group.is_empty() { Some(tree) } else { tree.lookup(group) };
    let whole =
        |name: &str| if group.is_empty() { name.to_string() } else { format!("{group}.{name}") };
    let strangers = beside
        .map_or(&[][..], Node::entries)
        .iter()
        .filter(|(key, _)| model::parameter(&whole(&key.text)).is_none());
    let names: Vec<&str> = strangers.map(|(key, _)| key.text.as_str()).collect();
    match crate::problem::nearest(name, names).and_then(|near| beside?.entry(near)) {
        Some((near, _)) => {
            problem.at(&near.span).help(format!("is `{}` meant to be `{name}`?", near.text))
        }
        None => problem,
    }
}

fn inadmissible(fault: &VehicleFault) -> Problem {
    match fault {
        VehicleFault::Missing(parameter) => Problem::error(
            "key-missing",
            format!(
                "the vehicle has no number `{}` ({}, in {})",
                parameter.key, parameter.meaning, parameter.unit
            ),
        ),
        VehicleFault::Inadmissible(parameter, value) => {
            let says = format!(
                "`{}` is {value}, which is not {}",
                parameter.key,
                parameter.admissible.in_words()
            );
            Problem::error("range", says)
        }
    }
}

/// Simulates a single vehicle over the whole of a track, without a campaign. `profile.csv` is in
/// the folder of the vehicle file, unless that names another file.
///
/// # Errors
/// All faults of the files, or the run diverges.
pub fn single(
    vehicle_file: (&Path, &Node),
    track_file: &Path,
    speed: f64,
    (settings, shift): (&[(String, f64)], f64),
    steps: Steps,
) -> Result<Signals, Problems> {
    let mut problems = Problems::default();
    let (path, tree) = vehicle_file;
    let beside = |key: &str, default: &str| {
        let name = tree.lookup(key).and_then(Node::scalar_text).unwrap_or(default);
        path.parent().unwrap_or(Path::new("")).join(name)
    };
    let vehicle = vehicle(tree, &mut problems);
    let (new, worn) =
        (beside("profile.file", "profile.csv"), beside("profile.worn_file", "profile_worn.csv"));
    let new = profile(&new, &new.display().to_string(), &mut problems);
    let worn = disk::may_be_file(&worn)
        .then(|| profile(&worn, &worn.display().to_string(), &mut problems))
        .flatten();
    let track =
        read_track(|wanted| read_record(track_file, &track_file.display().to_string(), wanted));
    let (Some(vehicle), Some(new), Ok(track)) =
        (vehicle, new, track.map_err(|problem| problems.push(problem)))
    else {
        return Err(problems);
    };
    let (vehicle, profile) = Machine { vehicle, new, worn }.with(settings)?;
    let (start, end) = (track.distance[0], track.distance[track.distance.len() - 1]);
    let half = vehicle.half_bogie_spacing + vehicle.half_wheelbase;
    let window = Window { from: start - shift, to: end - half - shift };
    let setup = Setup { vehicle: &vehicle, profile: &profile, track: &track, speed };
    Ok(made(&setup, window, steps)?)
}

fn track_of(campaign: &Campaign, section: &Cell) -> Result<TrackTable, Problem> {
    let source = campaign.record_source(RecordKind::Track, section)?;
    read_track(|wanted| source.read(wanted))
}

/// Reads a track file. Irregularities in mm, the unit of the model.
fn read_track(
    read: impl FnOnce(&[Wanted]) -> Result<Record, Vec<Problem>>,
) -> Result<TrackTable, Problem> {
    let length = Dimension::LENGTH;
    let columns = [
        ("distance", length, 1.0),
        ("curvature", Dimension::ONE / length, 1.0),
        ("cant", length, 1e3),
        ("alignment", length, 1e3),
        ("level", length, 1e3),
        ("cross level", length, 1e3),
        ("gauge", length, 1e3),
    ];
    let [distance, curvature, cant, alignment, level, cross_level, gauge] =
        read_table(columns, read).map_err(first)?;
    Ok(TrackTable { distance, curvature, cant, alignment, level, cross_level, gauge })
}

fn profile(path: &Path, shown: &str, problems: &mut Problems) -> Option<ProfileTable> {
    let columns = [
        ("displacement", Dimension::LENGTH, 1e3),
        ("radius deviation right", Dimension::LENGTH, 1e3),
        ("radius deviation left", Dimension::LENGTH, 1e3),
        ("contact angle right", Dimension::ONE, 1.0),
        ("contact angle left", Dimension::ONE, 1.0),
    ];
    let table = read_table(columns, |wanted| read_record(path, shown, wanted));
    let [displacement, right, left, angle_right, angle_left] =
        table.map_err(|found| problems.add(found)).ok()?;
    let (radius_deviation, contact_angle) = ([right, left], [angle_right, angle_left]);
    Some(ProfileTable { displacement, radius_deviation, contact_angle })
}

/// The columns of a table, each with its name, its dimension, and the factor from SI to the unit of
/// the model. A table has at least two points, in increasing order of the first column.
fn read_table<const N: usize>(
    columns: [(&str, Dimension, f64); N],
    read: impl FnOnce(&[Wanted]) -> Result<Record, Vec<Problem>>,
) -> Result<[Vec<f64>; N], Vec<Problem>> {
    let record = read(&columns.map(|(name, dimension, _)| Wanted::new(name, dimension)))?;
    let numbers = columns.map(|(name, _, factor)| -> Vec<f64> {
        let values = record.column(name).map_or(&[][..], |column| &column.values);
        values.iter().map(|value| value * factor).collect()
    });
    let (name, points) = (columns[0].0, &numbers[0]);
    if points.len() < 2 {
        let says = format!("{} has {} rows; at least two are needed", record.shown, points.len());
        return Err(Problem::error("too-short", says).into());
    }
    if let Some(row) = points.windows(2).position(|pair| pair[1] <= pair[0]) {
        let at = record
            .place(row + 1, record.column(name))
            .unwrap_or_else(|| Source::new(record.shown.as_str(), "").whole());
        return Err(error("not-increasing", format!("`{name}` does not increase here"), &at).into());
    }
    Ok(numbers)
}
