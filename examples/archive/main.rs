//! An archive of continuous runs of two vehicles, to measure how the evaluation grows with its
//! length: `cargo run --release --example archive -- --km 500 --out target/archive` makes 40 runs
//! of 12.5 km; `--runs` gives another number. `--lengths 5,5,2.8,1.7` makes one run of the first
//! vehicle for each zone instead, each of this length in km.
//!
//! Both sides are made by the vehicle model. The measurement has another friction and noise; all
//! else is the same. A run has one speed and curves that suit it, so that the sections of each zone
//! of Annex T are found in the runs of one speed.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss
)]

mod line;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use fishplate::data::record::Format;
use fishplate::data::write::{Digits, FileColumn, Values, parquet};
use fishplate::disk;
use fishplate::effects::{Channel, Gauss, Signals};
use fishplate::model::{
    CHANNELS, Profile, ProfileTable, Record, SAMPLING_RATE, Setup, TrackTable, Vehicle, Window,
    simulate,
};
use fishplate::problem::Problems;
use fishplate::simulate::{number_of, record_file};
use fishplate::source::Source;
use fishplate::units::Unit;
use fishplate::yaml;
use rayon::prelude::*;

/// Default number of runs, half of each vehicle.
const RUNS: usize = 40;
/// Length of the shortest run in m: straight track, a curve, and the margins of the model.
const SHORTEST: f64 = 1200.0;
/// Friction of the measurement; that of the simulation is in the vehicle file.
const FRICTION: f64 = 0.38;
/// Noise of the measurement: forces in N, accelerations in m/s^2, one standard deviation.
const NOISE: (f64, f64) = (200.0, 0.01);
/// Where runs are made.
const COUNTRIES: [&str; 4] = ["DE", "CH", "FR", "IT"];
/// The vehicles: name, and what differs from the coach of the examples.
const VEHICLES: [(&str, &[(&str, f64)]); 2] =
    [("coach", &[]), ("trailer", &[("car_body.mass", 27_000.0), ("secondary.cy", 3.0e4)])];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let after = |key: &str| {
        arguments.iter().position(|one| one == key).and_then(|at| arguments.get(at + 1))
    };
    let km = after("--km").and_then(|km| km.parse::<f64>().ok()).filter(|km| *km > 0.0);
    let runs = after("--runs")
        .and_then(|runs| runs.parse::<usize>().ok())
        .unwrap_or(RUNS)
        .max(VEHICLES.len());
    let listed = after("--lengths").map(|list| {
        list.split(',').filter_map(|km| km.parse::<f64>().ok()).map(|km| 1000.0 * km).collect()
    });
    // Lengths in m of the runs of each vehicle.
    let lengths: Option<Vec<f64>> =
        listed.or_else(|| km.map(|km| vec![1000.0 * km / runs as f64; runs / VEHICLES.len()]));
    let enough = |lengths: &Vec<f64>| {
        !lengths.is_empty() && lengths.iter().all(|length| *length >= SHORTEST)
    };
    let (Some(lengths), Some(out)) = (lengths.filter(enough), after("--out")) else {
        eprintln!(
            "arguments: --km LENGTH [--runs NUMBER] or --lengths KM,KM,...; --out FOLDER; with at least {SHORTEST} m for each run"
        );
        std::process::exit(2);
    };
    let vehicles = if km.is_some() { VEHICLES.len() } else { 1 };
    let all = VEHICLES.iter().take(vehicles).enumerate();
    match all
        .into_iter()
        .try_for_each(|(at, vehicle)| campaign(&PathBuf::from(out), at, *vehicle, &lengths))
    {
        Ok(()) => println!(
            "{} km in {} runs: {out}",
            vehicles as f64 * lengths.iter().sum::<f64>() / 1000.0,
            vehicles * lengths.len()
        ),
        Err(why) => {
            eprintln!("{why}");
            std::process::exit(3);
        }
    }
}

/// Writes the runs of one vehicle.
fn campaign(
    out: &Path,
    at: usize,
    (name, differs): (&str, &[(&str, f64)]),
    lengths: &[f64],
) -> Result<(), String> {
    let folder = out.join(name);
    let (vehicle, text) = vehicle(name, differs)?;
    let profile = Profile::new(&profile()?, None, &vehicle).ok_or("no profile")?;
    let wet = {
        let mut wet = vehicle.clone();
        wet.set("friction", FRICTION).map_err(|_| "the friction is not admissible")?;
        wet
    };
    let runs = VEHICLES.len() * lengths.len();
    let numbers: Vec<usize> = (0..lengths.len()).collect();
    let write = |inside: &str, bytes: &[u8]| {
        let path = folder.join(inside);
        disk::make_folder(path.parent().unwrap_or(&folder))
            .map_err(|error| format!("{}: {error}", path.display()))?;
        disk::keep(&path, bytes).map_err(|error| format!("{}: {error}", path.display()))
    };
    numbers.par_iter().try_for_each(|number| {
        let mut random = Gauss::new((1 + runs * at + number) as u64);
        let kind = line::KINDS[number % line::KINDS.len()];
        let length = lengths[*number];
        let track = line::track(&kind, length, &mut random);
        let window = Window { from: line::STRAIGHT, to: length };
        for (side, vehicle, noise) in [("simulation", &vehicle, 0.0), ("measurement", &wet, 1.0)] {
            let setup =
                Setup { vehicle, profile: &profile, track: &track, speed: kind.speed / 3.6 };
            let record = simulate(&setup, window, 1.into())
                .map_err(|failure| format!("{name}, run {number}: {failure}"))?;
            let bytes = record_of(record, kind.speed, noise, &mut random)?;
            write(&format!("runs/{number:02}-{side}.parquet"), &bytes)?;
        }
        write(&format!("runs/{number:02}-track.parquet"), &track_file(track)?)
    })?;
    let mut listed = String::new();
    for number in numbers {
        let file = |side: &str| format!("runs/{number:02}-{side}.parquet");
        let files = (file("measurement"), file("simulation"), file("track"));
        let country = COUNTRIES[number / line::KINDS.len() % COUNTRIES.len()];
        let (measurement, simulation, track) = files;
        let files = format!("measurement: {measurement}, simulation: {simulation}, track: {track}");
        let _ = writeln!(listed, "  run{number:02}: {{{files}, country: {country}}}");
    }
    write("vehicle.yaml", text.as_bytes())?;
    let head = format!(
        "name: Archive of the {name}\nprotocol: en14363-2016-annex-t-found-sections\nvehicle: vehicle.yaml\n"
    );
    write(
        "campaign.yaml",
        format!("{head}sampling_rate [Hz]: {SAMPLING_RATE}\nruns:\n{listed}").as_bytes(),
    )
}

/// The record as a file, with the speed in km/h.
fn record_of(
    Record { distance, channels }: Record,
    speed: f64,
    noise: f64,
    random: &mut Gauss,
) -> Result<Vec<u8>, String> {
    let unit_of = |name: &str| {
        CHANNELS.iter().find(|(known, _)| *known == name).map_or("km/h", |(_, unit)| unit)
    };
    let noisy = |(at, mut values): (usize, Vec<f64>)| {
        let (name, unit) = CHANNELS[at];
        let scale = noise * if unit == "kN" { NOISE.0 * 1e-3 } else { NOISE.1 };
        values.iter_mut().for_each(|value| *value += scale * random.next());
        Channel { name: name.to_string(), values }
    };
    let running = Channel { name: "speed".into(), values: vec![speed; distance.len()] };
    let channels = channels.into_iter().enumerate().map(noisy).chain([running]).collect();
    let signals = Signals { axis: distance, over_time: false, rate: SAMPLING_RATE, channels };
    let unit = |name: &str| Unit::parse(unit_of(name)).unwrap_or_else(|_| Unit::one());
    record_file(Format::Parquet, &signals, &unit).map_err(|problem| problem.says)
}

fn track_file(track: TrackTable) -> Result<Vec<u8>, String> {
    let columns = [
        ("distance [m]", track.distance, 2),
        ("curvature [1/m]", track.curvature, 9),
        ("cant [mm]", track.cant, 4),
        ("alignment [mm]", track.alignment, 3),
        ("level [mm]", track.level, 3),
        ("cross level [mm]", track.cross_level, 3),
        ("gauge [mm]", track.gauge, 3),
    ];
    let rounded = |values: Vec<f64>, decimals: i32| {
        let scale = 10_f64.powi(decimals);
        values.into_iter().map(|value| (value * scale).round() / scale).collect()
    };
    let column = |(heading, values, decimals): (&str, Vec<f64>, i32)| FileColumn {
        heading: heading.into(),
        values: Values::Numbers(rounded(values, decimals)),
        digits: None::<Digits>,
    };
    parquet(&columns.into_iter().map(column).collect::<Vec<_>>()).map_err(|problem| problem.says)
}

fn example(name: &str) -> Result<String, String> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/coach-good")).join(name);
    std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))
}

/// The coach of the examples with some parameters changed, and the text of its file.
fn vehicle(name: &str, differs: &[(&str, f64)]) -> Result<(Vehicle, String), String> {
    let source = Source::new("vehicle.yaml", example("vehicle.yaml")?);
    let tree = yaml::load(&source, &mut Problems::default()).ok_or("vehicle.yaml is no YAML")?;
    let number = |key: &str| tree.lookup(key).and_then(|node| number_of(node, key));
    let mut vehicle =
        Vehicle::from_values(number).map_err(|_| "vehicle.yaml lacks something".to_string())?;
    differs
        .iter()
        .try_for_each(|(key, value)| vehicle.set(key, *value))
        .map_err(|_| "a value is not admissible")?;
    let load = vehicle.static_wheel_load() * 1e-3;
    let facts = "category: passenger\nrunning_gear: bogies\nsecondary_suspension: true\nadmissible_speed: 140 km/h\n";
    Ok((vehicle, format!("name: {name}\n{facts}static_wheel_load: {load:.4} kN\n")))
}

fn profile() -> Result<ProfileTable, String> {
    let text = example("profile.csv")?;
    let cells = |line: &str| line.split(',').filter_map(|cell| cell.trim().parse().ok()).collect();
    let rows: Vec<Vec<f64>> = text.lines().skip(1).map(cells).collect();
    let column =
        |at: usize| rows.iter().filter_map(|row| row.get(at).copied()).collect::<Vec<f64>>();
    Ok(ProfileTable {
        displacement: column(0),
        radius_deviation: [column(1), column(2)],
        contact_angle: [column(3), column(4)],
    })
}
