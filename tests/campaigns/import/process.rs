//! What is done to records, compared with closed forms.

use std::f64::consts::PI;
use std::fs;
use std::path::Path;

use fishplate::data::Campaign;
use fishplate::data::record::{Record, Wanted, read_record};
use fishplate::problem::Problems;
use fishplate::units::{Dimension, Unit};

use crate::import::imported;

const SECTIONS: &str =
    "section,start [m],end [m],leading end,chainage [m]\nS01,120,180,A,100\nS02,120,180,B,100\n";

/// A column: name, unit, function of time.
type Made<'a> = (&'a str, &'a str, &'a dyn Fn(f64) -> f64);

/// A table of a foreign record at a rate, for 6 s: columns with unit and function of time.
fn table(columns: &[Made<'_>], rate: f64) -> String {
    let line = |cells: Vec<String>| cells.join(";") + "\n";
    let mut text = line(columns.iter().map(|(name, ..)| (*name).to_string()).collect());
    text += &line(columns.iter().map(|(_, unit, _)| (*unit).to_string()).collect());
    for row in 0..(6.0 * rate) as usize {
        text += &line(
            columns.iter().map(|(.., value)| format!("{:.9}", value(row as f64 / rate))).collect(),
        );
    }
    text
}

struct Case {
    folder: tempfile::TempDir,
}

impl Case {
    fn new(columns: &[Made<'_>], rate: f64) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("sections.csv"), SECTIONS).expect("written");
        for section in ["S01", "S02"] {
            fs::write(folder.path().join(format!("{section}.txt")), table(columns, rate))
                .expect("written");
        }
        Self { folder }
    }

    fn import(&self, body: &str) -> Problems {
        let text = format!("name: case\nsections: sections.csv\n{body}");
        let (problems, done) = imported(&text, "mapping.yaml", self.folder.path(), &self.out());
        assert!(done, "{}", problems.render(false));
        problems
    }

    fn out(&self) -> std::path::PathBuf {
        self.folder.path().join("out")
    }

    fn record(&self, section: &str, columns: &[(&str, &str)]) -> Record {
        let wanted: Vec<Wanted> =
            columns.iter().map(|(name, unit)| Wanted::new(*name, dimension(unit))).collect();
        let path = self.out().join(format!("measurement/{section}.csv"));
        read_record(&path, "record", &wanted)
            .unwrap_or_else(|problems| panic!("{}", Problems(problems).render(false)))
    }

    fn account(&self) -> String {
        fs::read_to_string(self.out().join("origin.yaml")).expect("an account")
    }
}

fn dimension(unit: &str) -> Dimension {
    Unit::parse(unit).expect("known").dimension
}

fn worst(found: &[f64], wanted: impl Fn(usize) -> f64) -> f64 {
    found.iter().enumerate().map(|(at, value)| (value - wanted(at)).abs()).fold(0.0, f64::max)
}

#[test]
fn sign_factor_offset_sum_and_unit() {
    let case = Case::new(
        &[
            ("Zeit", "ms", &|t| 1e3 * t),
            ("Weg", "km", &|t| 0.1 + 0.02 * t),
            ("a", "N", &|t| 1e3 * t),
            ("b", "kN", &|_| 2.0),
        ],
        200.0,
    );
    case.import(
        "measurement:\n  files: '{section}.txt'\n  time: Zeit\n  distance: Weg\n  channels:\n    S: {sum of: [a, -b], factor: 1.5, offset: 0.25 kN, in: kN}\n    A: -a\n",
    );
    let record = case.record("S01", &[("time", "s"), ("distance", "m"), ("S", "kN"), ("A", "N")]);
    assert_eq!(record.rows, 1200);
    assert_eq!(record.columns[2].unit.text, "kN");
    assert!(worst(&record.columns[0].values, |at| at as f64 / 200.0) < 1e-9);
    assert!(worst(&record.columns[1].values, |at| 100.0 + 0.1 * at as f64) < 1e-6);
    assert!(worst(&record.columns[2].values, |at| 1.5 * (5.0 * at as f64 - 2000.0) + 250.0) < 1e-3);
    assert!(worst(&record.columns[3].values, |at| -5.0 * at as f64) < 1e-3);
    assert!(case.account().contains("S = 1.5 (a - b) + 0.25 kN"), "{}", case.account());
}

#[test]
fn distance_from_speed_and_from_pulses() {
    let pulse: &dyn Fn(f64) -> f64 = &|t| if (10.0 * t).rem_euclid(1.0) < 0.48 { 0.0 } else { 5.0 };
    let case = Case::new(
        &[
            ("t", "s", &|t| t),
            ("v", "km/h", &|t| 3.6 * (20.0 + 2.0 * t)),
            ("p", "V", pulse),
            ("x", "-", &|t| t),
        ],
        200.0,
    );
    case.import(
        "measurement:\n  files: '{section}.txt'\n  time: t\n  distance: {from speed: v, start: {column: chainage}}\n  channels: {x: x}\n",
    );
    let record = case.record("S01", &[("distance", "m")]);
    // The trapezoidal rule is exact for a speed that grows evenly.
    assert!(
        worst(&record.columns[0].values, |at| 100.0
            + 20.0 * at as f64 / 200.0
            + (at as f64 / 200.0).powi(2))
            < 1e-6
    );
    assert!(
        case.account().contains(
            "integral of v over time (trapezoidal rule) from 100 m (the column `chainage`"
        ),
        "{}",
        case.account()
    );

    case.import(
        "measurement:\n  files: '{section}.txt'\n  time: t\n  distance: {from trigger: p, every: 2 m, start: 101 m}\n  channels: {x: x}\n",
    );
    let record = case.record("S01", &[("time", "s"), ("distance", "m")]);
    // A pulse each 0.1 s, the first at 0.05 s within one sample: 20 m/s.
    let (time, distance) = (&record.columns[0].values, &record.columns[1].values);
    assert!(
        worst(distance, |at| 101.0 + 20.0 * (time[at] - 0.0475)) < 1e-6,
        "{:?}",
        &distance[..3]
    );
    assert!(time[0] > 0.047 && time[time.len() - 1] < 5.96);
}

#[test]
fn clocks_are_corrected() {
    let case = Case::new(&[("t", "s", &|t| t), ("s", "m", &|t| 100.0 + 20.0 * t)], 200.0);
    case.import("measurement:\n  files: '{section}.txt'\n  time: {from: t, shift: {S01: 0.5 s}, drift: 100 ppm}\n  distance: s\n  channels: {copy: {from: s, in: m}}\n");
    let of = |section: &str| case.record(section, &[("time", "s")]).columns[0].values.clone();
    assert!(worst(&of("S01"), |at| at as f64 / 200.0 / 1.0001 + 0.5) < 1e-9);
    assert!(worst(&of("S02"), |at| at as f64 / 200.0 / 1.0001) < 1e-9);
}

#[test]
fn another_rate_is_filtered() {
    let tone: &dyn Fn(f64) -> f64 = &|t| (2.0 * PI * 20.0 * t).sin() + (2.0 * PI * 180.0 * t).sin();
    let case = Case::new(
        &[("t", "s", &|t| t), ("s", "m", &|t| 100.0 + 20.0 * t), ("a", "m/s^2", tone)],
        600.0,
    );
    case.import("measurement:\n  files: '{section}.txt'\n  time: t\n  rate: 200 Hz\n  distance: s\n  channels: {a: a}\n");
    let record = case.record("S01", &[("time", "s"), ("distance", "m"), ("a", "m/s^2")]);
    let middle = 200..1000;
    let wanted = |at: usize| (2.0 * PI * 20.0 * (at + 200) as f64 / 200.0).sin();
    assert!(worst(&record.columns[2].values[middle], wanted) < 5e-4);
    assert!(worst(&record.columns[1].values, |at| 100.0 + 0.1 * at as f64) < 1e-6);
    assert!(case.account().contains("resampled from 600 Hz to 200 Hz"), "{}", case.account());
}

#[test]
fn turned_sections_exchange_channels_and_signs() {
    let case = Case::new(
        &[
            ("t", "s", &|t| t),
            ("s", "m", &|t| 100.0 + 20.0 * t),
            ("a", "kN", &|_| 1.0),
            ("b", "kN", &|_| 2.0),
            ("c", "kN", &|_| 3.0),
        ],
        200.0,
    );
    case.import(
        "turning: {exchange: {Y_1R: Y_4L}, reverse sign: [Y_1R, Y_4L]}\nmeasurement:\n  files: '{section}.txt'\n  time: t\n  distance: s\n  turned: {leading end: B}\n  channels: {Y_1R: a, Y_4L: b, z: c}\n",
    );
    let first = |section: &str| {
        case.record(section, &[("Y_1R", "kN"), ("Y_4L", "kN"), ("z", "kN")])
            .columns
            .iter()
            .map(|column| column.values[0])
            .collect::<Vec<_>>()
    };
    assert_eq!(first("S01"), [1e3, 2e3, 3e3]);
    assert_eq!(first("S02"), [-2e3, -1e3, 3e3]);
}

#[test]
fn the_distance_is_matched_with_the_track() {
    let curvature = |x: f64| 1e-3 * ((x - 130.0) / 10.0).clamp(0.0, 1.0) + 2e-5 * (x / 7.0).sin();
    let case = Case::new(
        &[
            ("t", "s", &|t| t),
            ("v", "m/s", &|_| 20.0),
            ("k", "1/m", &|t| curvature(103.7 + 20.0 * t)),
            ("x", "-", &|t| t),
        ],
        200.0,
    );
    fs::create_dir(case.folder.path().join("track")).expect("made");
    let track: String = (0..=600)
        .map(|at| {
            format!(
                "{},{:.9}\n",
                80.0 + 0.25 * f64::from(at),
                curvature(80.0 + 0.25 * f64::from(at))
            )
        })
        .collect();
    for section in ["S01", "S02"] {
        fs::write(
            case.folder.path().join(format!("track/{section}.csv")),
            format!("distance [m],curvature [1/m]\n{track}"),
        )
        .expect("written");
    }
    let body = |sign: &str| {
        format!(
            "track: track\nmeasurement:\n  files: '{{section}}.txt'\n  time: t\n  distance: {{from speed: v, start: 100 m, match: {{curvature: {sign}k, within: 10 m}}}}\n  channels: {{x: x}}\n"
        )
    };
    case.import(&body(""));
    let record = case.record("S01", &[("distance", "m")]);
    assert!((record.columns[0].values[0] - 103.7).abs() < 0.02, "{}", record.columns[0].values[0]);
    assert!(
        case.account().contains("distance moved by +3.70 m to match curvature"),
        "{}",
        case.account()
    );
    let text = format!("name: case\nsections: sections.csv\n{}", body("-"));
    let (problems, done) =
        imported(&text, "mapping.yaml", case.folder.path(), &case.folder.path().join("other"));
    assert!(
        !done && problems.render(false).contains("sign opposite to the track file"),
        "{}",
        problems.render(false)
    );
}

#[test]
fn records_are_cut_and_offset() {
    let case = Case::new(&[("t", "s", &|t| t), ("s", "m", &|t| 100.0 + 20.0 * t)], 200.0);
    case.import("margin: 10 m\nmeasurement:\n  files: '{section}.txt'\n  time: t\n  distance: s\n  offsets: {S01: 0.35 m}\n  channels: {copy: {from: s, in: m}}\n");
    let of = |section: &str| case.record(section, &[("distance", "m")]).columns[0].values.clone();
    let (first, second) = (of("S01"), of("S02"));
    assert!(
        (first[0] - 110.05).abs() < 1e-9 && (second[0] - 110.0).abs() < 1e-9,
        "{} {}",
        first[0],
        second[0]
    );
    assert!(second[second.len() - 1] <= 190.0 + 1e-9 && second[second.len() - 1] > 189.89);
    assert!(case.account().contains("+0.35 m added to the distance"), "{}", case.account());
}

/// The column of the table of sections is left to the evaluation, which adds it to the measurement
/// only.
#[test]
fn offsets_of_the_table_are_applied_when_records_are_read() {
    let case = Case::new(&[("t", "s", &|t| t), ("s", "m", &|t| 100.0 + 20.0 * t)], 200.0);
    let table = "section,start [m],end [m],offset [m]\nS01,120,180,0.35\nS02,120,180,\n";
    fs::write(case.folder.path().join("sections.csv"), table).expect("written");
    let side = "  files: '{section}.txt'\n  time: t\n  distance: s\n  channels: {copy: {from: s, in: m}}\n";
    case.import(&format!("measurement:\n{side}simulation:\n{side}"));
    let mut problems = Problems::default();
    let campaign = Campaign::open(&case.out(), &mut problems)
        .unwrap_or_else(|| panic!("{}", problems.render(false)));
    let first = |kind: fishplate::data::RecordKind, section: usize| {
        let wanted =
            [Wanted::new("distance", Dimension::LENGTH), Wanted::new("copy", Dimension::LENGTH)];
        let (record, _) =
            campaign.read(kind.into(), &campaign.names[section], &wanted, None).expect("readable");
        (record.columns[0].values[0], record.columns[1].values[0])
    };
    use fishplate::data::RecordKind::{Measurement, Simulation};
    assert_eq!(
        (first(Measurement, 0), first(Measurement, 1), first(Simulation, 0)),
        ((100.35, 100.0), (100.0, 100.0), (100.0, 100.0))
    );
    assert_eq!(campaign.offsets().collect::<Vec<_>>(), [("S01", "distance", 0.35)]);
}

#[test]
fn the_same_files_give_the_same_bytes() {
    let columns: [Made<'_>; 3] =
        [("t", "s", &|t| t), ("s", "m", &|t| 100.0 + 20.0 * t), ("a", "kN", &|t| t * t)];
    let case = Case::new(&columns, 200.0);
    let body =
        "measurement:\n  files: '{section}.txt'\n  time: t\n  distance: s\n  channels: as named\n";
    case.import(body);
    let read = || {
        ["campaign.yaml", "origin.yaml"]
            .map(|name| fs::read(case.out().join(name)).unwrap_or_default())
    };
    let before = read();
    case.import(body);
    assert_eq!(read(), before);
    assert!(Path::new(&case.out()).join("measurement/S02.csv").exists());
}
