//! Campaigns in temporary folders, and the run of a protocol over one without the command line.

#![allow(dead_code, reason = "each test file uses a part of it")]

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use fishplate::certify::{certify, compile};
use fishplate::check::family;
use fishplate::check::plan::SetBy;
use fishplate::check::{Override, Overrides};
use fishplate::data::Campaign;
use fishplate::library;
use fishplate::problem::Problems;
use fishplate::result::Certification;
use fishplate::run::Settings;
use fishplate::source::Source;
use fishplate::syntax::document::Text;
use tempfile::TempDir;

/// A protocol, by name or path, over a campaign, with parameters set as `name=value`.
pub fn certified(campaign: &Path, protocol: &str, set: &[&str]) -> Result<Certification, Problems> {
    let mut problems = Problems::default();
    let source = library::find(protocol, None).map_err(Problems::from)?;
    let family = family::read(&source, &library::parent, &mut problems);
    let mut overrides = Overrides::new();
    for set in set {
        let (name, value) = set.split_once('=').expect("name=value");
        let text =
            Text { text: value.to_string(), span: Source::new("set", value).whole(), exact: true };
        overrides.insert(name.to_string(), Override { text, set_by: SetBy::CommandLine });
    }
    let compiled = compile(family, &overrides, &mut problems);
    let campaign = Campaign::open(campaign, &mut problems);
    let (Some(compiled), Some(campaign), false) = (compiled, campaign, problems.any_error()) else {
        return Err(problems);
    };
    certify(&compiled, &campaign, Settings { traces: 0 }, &|_| {})
}

/// A copy of a folder that is gone when it is dropped.
pub fn copy(from: &Path) -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    copy_into(from, folder.path());
    folder
}

fn copy_into(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder");
    for entry in fs::read_dir(from).unwrap_or_else(|error| panic!("{}: {error}", from.display())) {
        let entry = entry.expect("readable");
        let (path, to) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() {
            copy_into(&path, &to);
        } else {
            fs::copy(&path, &to).expect("copied");
        }
    }
}

/// Replaces a text that must be there, everywhere in a file.
#[track_caller]
pub fn replace(path: &Path, from: &str, to: &str) {
    let text =
        fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert!(text.contains(from), "{} has no `{from}`", path.display());
    fs::write(path, text.replace(from, to)).expect("written");
}

/// Changes the lines of a file; the header is the first.
#[track_caller]
pub fn lines(path: &Path, change: impl FnOnce(&mut Vec<String>)) {
    let text =
        fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut lines: Vec<String> = text.lines().map(str::to_string).collect();
    change(&mut lines);
    fs::write(path, lines.join("\n") + "\n").expect("written");
}

/// Puts a text into a cell; row 0 is the header.
#[track_caller]
pub fn cell(path: &Path, row: usize, column: &str, value: &str) {
    lines(path, |lines| {
        let at = lines[0]
            .split(',')
            .position(|heading| heading == column)
            .unwrap_or_else(|| panic!("no column {column}"));
        let mut cells: Vec<&str> = lines[row].split(',').collect();
        cells[at] = value;
        lines[row] = cells.join(",");
    });
}

/// Samples per second of the records of [`tiny`].
pub const RATE: f64 = 100.0;
/// Record on both sides of a section [m].
const MARGIN: f64 = 40.0;

/// A section of [`tiny`]: zone, length [m], radius [m], cant [mm], speed [km/h].
const KINDS: [(u8, f64, f64, f64, f64); 4] = [
    (1, 250.0, 0.0, 0.0, 144.0),
    (2, 100.0, 1000.0, 50.0, 108.0),
    (3, 100.0, 500.0, 90.0, 90.0),
    (4, 70.0, 300.0, 95.0, 72.0),
];
/// Standard gravity [m/s^2].
const G: f64 = 9.806_65;

/// Three sections in each of four zones, S01 to S12, that validate and are plausible; without track
/// records. The signals are sums of waves about the values that the curve asks for.
pub fn tiny() -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    write_tiny(folder.path());
    folder
}

pub fn write_tiny(folder: &Path) {
    for kind in ["measurement", "simulation"] {
        fs::create_dir_all(folder.join(kind)).expect("a folder");
    }
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).expect("written");
    write(
        "campaign.yaml",
        "name: Tiny\nvehicle: vehicle.yaml\nsections: sections.csv\nmeasurement: measurement\nsimulation: simulation\n",
    );
    write(
        "vehicle.yaml",
        "name: Wagon\ncategory: passenger\nrunning_gear: bogies\nsecondary_suspension: true\nstatic_wheel_load: 50\nadmissible_speed: 130 km/h\n",
    );
    let mut sections = String::from(
        "section,zone [-],start [m],end [m],radius [m],direction,cant [mm],cant deficiency [mm],speed [km/h]\n",
    );
    for (number, (zone, length, radius, cant, speed)) in
        KINDS.iter().flat_map(|kind| [kind; 3]).enumerate()
    {
        let name = format!("S{:02}", number + 1);
        let direction = if *zone == 1 { "straight" } else { ["right", "left"][number % 2] };
        let turn = match direction {
            "right" => 1.0,
            "left" => -1.0,
            _ => 0.0,
        };
        let metres_per_second: f64 = speed / 3.6;
        let deficiency =
            if *zone == 1 { 0.0 } else { 1500.0 * metres_per_second.powi(2) / (G * radius) - cant };
        let radius = if *zone == 1 { String::new() } else { radius.to_string() };
        let end = MARGIN + length;
        let _ = writeln!(
            sections,
            "{name},{zone},{MARGIN},{end},{radius},{direction},{cant},{deficiency:.1},{speed}"
        );
        let unbalanced = turn * G * deficiency / 1500.0;
        let of = |gain, phase| {
            record(number, end + MARGIN, metres_per_second, (turn, unbalanced), gain, phase)
        };
        write(&format!("measurement/{name}.csv"), &of(1.0, 0.0));
        write(&format!("simulation/{name}.csv"), &of(1.02, 0.1));
    }
    write("sections.csv", &sections);
}

/// `gain` and `phase` set simulation and measurement apart. `turn` is 1 in right-hand curves,
/// `unbalanced` the lateral acceleration in the plane of the track.
fn record(
    number: usize,
    length: f64,
    speed: f64,
    (turn, unbalanced): (f64, f64),
    gain: f64,
    phase: f64,
) -> String {
    let channels: Vec<String> = ["Y", "Q"]
        .iter()
        .flat_map(|name| ["1R", "1L", "3R", "3L"].map(|wheel| format!("{name}_{wheel}")))
        .collect();
    let mut text = String::from("time [s],distance [m]");
    for channel in &channels {
        let _ = write!(text, ",{channel} [kN]");
    }
    text.push_str(",ay_I [m/s^2],ay_II [m/s^2],az_I [m/s^2],az_II [m/s^2]\n");
    let rows = (length / speed * RATE).ceil() as u32;
    for row in 0..=rows {
        let time = f64::from(row) / RATE;
        let _ = write!(text, "{time:.2},{:.3}", time * speed);
        let wave = |nth: usize| {
            // Waves that grow shorter: read from its end, a record is another. Other ones in each
            // section: on one track, no two sections are alike.
            let rate = 6.3 + 0.9 * number as f64;
            let at = rate * time + 0.4 * time.powi(2) + 0.7 * nth as f64 + phase;
            gain * (at.sin() + 0.5 * (2.3 * at).sin() + 0.1 * (9.1 * at).sin())
        };
        for (nth, channel) in channels.iter().enumerate() {
            let outward = if channel.ends_with('L') { turn } else { -turn };
            let (mean, size) = if channel.starts_with('Y') {
                (-12.0 * turn, 3.0)
            } else {
                (50.0 + 5.0 * outward, 5.0)
            };
            let _ = write!(text, ",{:.3}", gain * mean + size * wave(nth));
        }
        for nth in 0..4 {
            let mean = if nth < 2 { 1.2 * unbalanced } else { 0.0 };
            let _ = write!(text, ",{:.5}", mean + 0.3 * wave(20 + nth));
        }
        text.push('\n');
    }
    text
}
