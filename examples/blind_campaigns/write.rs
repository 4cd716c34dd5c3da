//! Writes one campaign as a folder.

use std::path::Path;

use fishplate::data::record::Format;
use fishplate::data::table::Cell;
use fishplate::data::write::Outputs;
use fishplate::disk::SetKind;
use fishplate::effects::{Applied, Catalogue, Channel, Gauss, Signals};
use fishplate::model::{
    CHANNELS, Profile, ProfileTable, SAMPLING_RATE, Setup, TrackTable, Vehicle, Window, simulate,
};
use fishplate::simulate::{Fact, Plan, Section, record_file};
use fishplate::source::Source;
use fishplate::units::Unit;

use super::cases::{Case, Set};
use super::hidden::{catalogue, chosen, told};
use super::line::{Irregularities, Stretch, measured, stretches};
use super::truth::{DECLARED, Making, World, noise};
use super::vehicles::{Design, example};

/// Writes a campaign of a set with a seed.
///
/// # Errors
/// The campaign and the reason.
pub fn campaign(out: &Path, set: (&Set, u64), case: &Case) -> Result<(), String> {
    // If the vehicle derails on a line, another line is drawn.
    let mut tried = (0..DRAWS).map(|draw| make(out, set, case, draw));
    let made = tried.by_ref().find(Result::is_ok).or_else(|| Some(make(out, set, case, 0)));
    made.unwrap_or(Ok(())).map_err(|why| format!("campaign {}: {why}", case.number))
}

/// Maximum number of lines drawn for a campaign.
const DRAWS: u64 = 6;

fn make(out: &Path, (set, seed): (&Set, u64), case: &Case, draw: u64) -> Result<(), String> {
    let mut random = Gauss::new(seed + 1000 * case.number as u64 + draw);
    let catalogue = catalogue()?;
    let effects = drawn(&catalogue, case, &mut random)?;
    let nominal = case.design.vehicle()?;
    let (new, worn) = (profile("profile.csv")?, profile("profile_worn.csv")?);
    let world = World::draw(&mut random);
    let name = format!("{}-{:02}", set.name, case.number);
    let mut outputs = Outputs::of(SetKind::Campaign, out.join(&name));
    let mut add =
        |inside: &str, bytes: &[u8]| outputs.add(inside, bytes).map_err(|problem| problem.says);
    let mut table = String::from(
        "section,zone [-],start [m],end [m],radius [m],direction,cant [mm],cant deficiency [mm],speed [km/h]\n",
    );
    for (at, stretch) in
        stretches(case.design, set.sections_per_zone, &mut random).iter().enumerate()
    {
        let irregularities = Irregularities::draw(&mut random);
        let track = measured(stretch, &irregularities);
        let plan = Plan::new(&catalogue, &effects, &section(stretch), None)
            .map_err(|problem| problem.says)?;
        let making = Making {
            nominal: &nominal,
            profile: &new,
            worn: Some(&worn),
            track: &track,
            stretch,
            settings: &plan.settings,
            shift: plan.shift(),
            outside: case.outside,
        };
        let mut signals = world
            .record(&making, &mut random)
            .map_err(|why| format!("section {}: {why}", stretch.name))?;
        world.calibrate(&mut signals);
        plan.operate(&mut signals, &section(stretch)).map_err(|problem| problem.says)?;
        noise(&mut signals, &mut random);
        if let Some(outside) = case.outside {
            for channel in &mut signals.channels {
                let (offset, gain) = outside.on_channel(&channel.name, at);
                channel.values.iter_mut().for_each(|value| *value = gain * *value + offset);
            }
        }
        let unit = |name: &str| {
            Unit::parse(
                CHANNELS.iter().find(|(known, _)| *known == name).map_or("-", |(_, unit)| unit),
            )
            .unwrap_or_else(|_| Unit::one())
        };
        let bytes = |signals: &Signals| {
            record_file(Format::Csv, signals, &unit).map_err(|problem| problem.says)
        };
        add(&format!("measurement/{}.csv", stretch.name), &bytes(&signals)?)?;
        add(
            &format!("simulation/{}.csv", stretch.name),
            &bytes(&simulated(&nominal, &new, &track, stretch)?)?,
        )?;
        add(&format!("track/{}.csv", stretch.name), track_text(&track).as_bytes())?;
        table += &row(stretch);
    }
    add("sections.csv", table.as_bytes())?;
    add("profile.csv", copied("profile.csv")?.as_bytes())?;
    add("profile_worn.csv", copied("profile_worn.csv")?.as_bytes())?;
    add("vehicle.yaml", vehicle_text(case.design, &nominal).as_bytes())?;
    add("campaign.yaml", campaign_text(&name, &nominal, SAMPLING_RATE).as_bytes())?;
    add("truth.json", truth_text(case, &effects).as_bytes())?;
    outputs.commit().map_err(|problem| problem.says)
}

/// Effects with their sizes drawn.
fn drawn(catalogue: &Catalogue, case: &Case, random: &mut Gauss) -> Result<Vec<Applied>, String> {
    let mut texts = Vec::new();
    for effect in &case.effects {
        let Some((before, after)) = effect.split_once('~') else {
            texts.push(effect.clone());
            continue;
        };
        let (number, rest) = after
            .split_once(' ')
            .map_or((after, String::new()), |(number, rest)| (number, format!(" {rest}")));
        let number: f64 = number.parse().map_err(|_| format!("`{number}` is not a number"))?;
        texts.push(format!("{before}{:.5}{rest}", number * (0.85 + 0.3 * random.uniform())));
    }
    chosen(catalogue, &texts)
}

/// The section, for the confinements of the catalogue.
pub fn section(stretch: &Stretch) -> Section {
    let fact = |name: &str, text: String| Fact { name: name.to_string(), text, unit: None };
    let facts = vec![
        fact("zone", stretch.zone.to_string()),
        fact("direction", stretch.direction().to_string()),
    ];
    let cell = Cell::new(stretch.name.clone(), Source::new("sections.csv", "").whole());
    Section {
        cell,
        start: stretch.start,
        end: stretch.end,
        speed: Some(stretch.speed / 3.6),
        facts,
    }
}

/// The record of the simulation, without any effect, on the measured track.
pub fn simulated(
    vehicle: &Vehicle,
    table: &ProfileTable,
    track: &TrackTable,
    stretch: &Stretch,
) -> Result<Signals, String> {
    let profile = Profile::new(table, None, vehicle).ok_or("no profile")?;
    let setup = Setup { vehicle, profile: &profile, track, speed: stretch.speed / 3.6 };
    let record = simulate(&setup, Window::around(stretch.start, stretch.end), 1.into())
        .map_err(|failure| failure.to_string())?;
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

pub fn copied(name: &str) -> Result<String, String> {
    std::fs::read_to_string(example().join(name)).map_err(|error| format!("{name}: {error}"))
}

pub fn profile(name: &str) -> Result<ProfileTable, String> {
    let text = copied(name)?;
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').filter_map(|cell| cell.trim().parse().ok()).collect())
        .collect();
    let column =
        |at: usize| rows.iter().filter_map(|row| row.get(at).copied()).collect::<Vec<f64>>();
    Ok(ProfileTable {
        displacement: column(0),
        radius_deviation: [column(1), column(2)],
        contact_angle: [column(3), column(4)],
    })
}

pub fn row(stretch: &Stretch) -> String {
    let Stretch { name, zone, start, end, cant, deficiency, speed, .. } = stretch;
    let radius = stretch.radius.map_or(String::new(), |radius| format!("{radius}"));
    format!(
        "{name},{zone},{start:.2},{end:.2},{radius},{},{cant:.0},{deficiency:.1},{speed:.1}\n",
        stretch.direction()
    )
}

pub fn track_text(track: &TrackTable) -> String {
    let mut text = String::from(
        "distance [m],curvature [1/m],cant [mm],alignment [mm],level [mm],cross level [mm],gauge [mm]\n",
    );
    for i in 0..track.distance.len() {
        let (distance, curvature, cant) = (track.distance[i], track.curvature[i], track.cant[i]);
        let (alignment, level, cross, gauge) =
            (track.alignment[i], track.level[i], track.cross_level[i], track.gauge[i]);
        text += &format!(
            "{distance:.2},{curvature:.9},{cant:.4},{alignment:.3},{level:.3},{cross:.3},{gauge:.3}\n"
        );
    }
    text
}

/// All parameters of the model that differ from neutral, nested as in a vehicle file.
pub fn vehicle_text(design: &Design, vehicle: &Vehicle) -> String {
    let mut text = format!(
        "name: {}\ncategory: {}\nrunning_gear: bogies\nsecondary_suspension: {}\nstatic_wheel_load: {:.4} kN\n",
        design.name,
        design.category,
        design.secondary_suspension,
        vehicle.static_wheel_load() * 1e-3
    );
    let mut group = "";
    for parameter in fishplate::model::PARAMETERS {
        let value = vehicle.get(parameter.key).unwrap_or(0.0);
        let unit =
            if parameter.unit == "-" { String::new() } else { format!(" {}", parameter.unit) };
        match parameter.key.split_once('.') {
            None => text += &format!("{}: {value:e}{unit}\n", parameter.key),
            Some((own, name)) => {
                if own != group {
                    text += &format!("{own}:\n");
                    group = own;
                }
                let value = if parameter.key == "out_of_roundness.side" {
                    "both".to_string()
                } else {
                    format!("{value:e}{unit}")
                };
                text += &format!("  {name}: {value}\n");
            }
        }
    }
    text
}

pub fn campaign_text(name: &str, vehicle: &Vehicle, rate: f64) -> String {
    format!(
        "name: {name}\nvehicle: vehicle.yaml\nsections: sections.csv\nmeasurement: measurement\nsimulation: simulation\ntrack: track\n\
         sampling_rate [Hz]: {rate}\nassumed_friction [-]: {}\nsimulation_ran_on: measured track\ndeclared_tolerances:\n{}",
        vehicle.friction,
        DECLARED.lines()
    )
}

fn truth_text(case: &Case, effects: &[Applied]) -> String {
    use serde_json::{Value, json};
    let mut list: Vec<Value> = effects.iter().map(told).collect();
    list.extend(case.outside.map(|outside| json!({"name": outside.name(), "parameters": {}})));
    let truth = json!({"kind": case.kind, "effects": list, "vehicle": case.design.name});
    serde_json::to_string_pretty(&truth).unwrap_or_default() + "\n"
}
