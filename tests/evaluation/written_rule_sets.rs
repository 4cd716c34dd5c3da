//! The rule sets of `cases/rule-sets` against NumPy and SciPy: `expected.py` there makes the same
//! campaign, of whole numbers, and the values, limits, statistics, outcomes and verdicts of
//! `expected.json`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;

use crate::common::campaign::certified;
use crate::rule_sets::triangle;
use fishplate::result::{
    Certification, Outcome, QuantityResult, Reported, StatisticResult, Verdict,
};

const FOLDER: &str = "tests/cases/rule-sets";
/// Samples of a record, 200 a second; the first one of a section.
const ROWS: i64 = 2501;
const FIRST: i64 = 200;
/// mm between a measured sample and the simulated one.
const LATE: i64 = 30;
/// Sections of the campaign that is cut by the time, and the sets that are.
const OVER_TIME: usize = 4;
const BY_TIME: [&str; 3] = ["02c-fra-windows", "04-en12299", "05-msdv"];
/// Parameters, so that not all is met, and not all is missed.
const SET: [(&str, &[&str]); 2] = [
    ("01-aar-m1001", &["lv_limit=0.7", "sum_limit=1.2"]),
    ("12-two-stage", &["mean_limit_share=0.2"]),
];
/// Share of a value, or of 0.001 of its unit for smaller ones.
const TOLERANCE: f64 = 1e-9;

/// Name, last measured sample, zone, radius in m, direction, speed in km/h, conicity in 1/1000,
/// country, line, site.
type Section = (&'static str, i64, u8, &'static str, &'static str, i64, u16, [&'static str; 3]);

#[rustfmt::skip]
const SECTIONS: [Section; 13] = [
    ("S01", 2300, 1, "", "straight", 144, 40, ["IT", "main", "A"]),
    ("S02", 2300, 1, "", "straight", 180, 120, ["IT", "main", ""]),
    ("S03", 2300, 1, "", "straight", 144, 300, ["FR", "main", ""]),
    ("S04", 2300, 2, "1000", "right", 108, 80, ["FR", "main", ""]),
    ("S05", 2300, 2, "1200", "left", 144, 250, ["FR", "branch", ""]),
    ("S06", 2300, 2, "900", "right", 108, 240, ["NO", "branch", ""]),
    ("S07", 2300, 3, "500", "left", 72, 100, ["NO", "branch", ""]),
    ("S08", 2000, 3, "400", "right", 108, 60, ["NO", "branch", ""]),
    ("S09", 2300, 3, "600", "left", 72, 310, ["IT", "branch", ""]),
    ("S10", 2300, 4, "300", "right", 54, 90, ["IT", "branch", ""]),
    ("S11", 2300, 4, "350", "left", 72, 150, ["FR", "main", ""]),
    ("S12", 1400, 4, "300", "right", 54, 20, ["FR", "main", ""]),
    ("S13", 2300, 1, "", "straight", 144, 70, ["IT", "main", "A"]),
];

const VEHICLE: &str = "name: Coach
category: passenger
running_gear: bogies
secondary_suspension: true
static_wheel_load: 60
admissible_speed: 140 km/h
uncertainty:
  numerical: 0.3 kN
  input: 0.04
  measured: 0.6 kN
  Y: 0.9 kN
  Y_simulated: 1.1 kN
  Q: 1.5 kN
  Q_simulated: 1.2 kN
  ay: 0.05 m/s^2
  ay_simulated: 0.04 m/s^2
";

/// Name, unit, mean, then quarter of the period in samples and size of each wave.
type Channel = (String, &'static str, i64, [(i64, i64); 3]);

fn channels() -> Vec<Channel> {
    let mut all = Vec::new();
    for (name, mean, waves) in [
        ("Y", 9000, [(97, 16_000), (31, 7000), (7, 2000)]),
        ("Q", 60_000, [(113, 18_000), (23, 12_000), (5, 3000)]),
    ] {
        for wheel in ["1R", "1L", "2R", "2L", "3R", "3L", "4R", "4L"] {
            all.push((format!("{name}_{wheel}"), "N", mean, waves));
        }
    }
    let body = |big| [(129, big), (41, big / 2), (11, big / 3)];
    for (name, unit, mean, waves) in [
        ("ay", "mm/s^2", 300, body(900)),
        ("az", "mm/s^2", 0, body(1300)),
        ("ayb", "mm/s^2", 0, body(2100)),
        ("roll", "mrad", 4, [(173, 40), (37, 12), (11, 3)]),
    ] {
        for gear in ["I", "II"] {
            all.push((format!("{name}_{gear}"), unit, mean, waves));
        }
    }
    all
}

/// mm from sample to sample: 54 km/h are 15 m/s, 75 mm in 1/200 s.
fn step(number: usize) -> i64 {
    SECTIONS[number].5 * 75 / 54
}

fn thousandths(number: i64) -> String {
    format!("{}.{:03}", number / 1000, number % 1000)
}

/// `side` is 0 for the measurement and 1 for the simulation.
fn record(section: usize, side: i64) -> String {
    let number = i64::try_from(section).expect("a number");
    let turn = if SECTIONS[section].4 == "left" { -1 } else { 1 };
    let channels = channels();
    let mut text = "time [s],distance [m]".to_string();
    for (name, unit, ..) in &channels {
        let _ = write!(text, ",{name} [{unit}]");
    }
    text.push('\n');
    for i in 0..ROWS {
        text += &thousandths(5 * i);
        text.push(',');
        text += &thousandths(i * step(section) + side * LATE);
        for (at, (name, _, mean, waves)) in (0..).zip(&channels) {
            let mut value = if name.starts_with('Q') { *mean } else { mean * turn };
            // What the simulation is off by, from -1/5 to 1/5 of the largest wave.
            value += side * (waves[0].1 * ((5 * number + 3 * at) % 9 - 4)).div_euclid(20);
            // A rise of its own tells one period from the next.
            value += waves[0].1 * i * i / (2 * ROWS * ROWS);
            for (k, (quarter, size)) in (1..).zip(waves) {
                let shift = 37 * at * k + 1000 * number + 4 * side * (number % 3);
                let size = size + size * side * (number % 4) / 32;
                value += triangle(i + shift, quarter + at % 5 + 2 * (number % 5), size);
            }
            let _ = write!(text, ",{value}");
        }
        text.push('\n');
    }
    text
}

fn campaign(over_time: bool) -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, text: &str| {
        fs::write(folder.path().join(name), text).expect("written");
    };
    let count = if over_time { OVER_TIME } else { SECTIONS.len() };
    for (side, kind) in [(0, "measurement"), (1, "simulation")] {
        fs::create_dir(folder.path().join(kind)).expect("a folder");
        for (number, section) in SECTIONS[..count].iter().enumerate() {
            write(&format!("{kind}/{}.csv", section.0), &record(number, side));
        }
    }
    write(
        "campaign.yaml",
        "name: Triangles\nvehicle: vehicle.yaml\nsections: sections.csv\nmeasurement: measurement\nsimulation: simulation\n",
    );
    write("vehicle.yaml", VEHICLE);
    let unit = if over_time { "s" } else { "m" };
    let mut table = format!(
        "section,start [{unit}],end [{unit}],zone [-],radius [m],direction,cant [mm],cant deficiency [mm],speed [km/h],conicity [-],country,line,site\n"
    );
    for (number, section) in SECTIONS[..count].iter().enumerate() {
        let (name, last, zone, radius, direction, speed, conicity, [country, line, site]) = section;
        let at = |i: i64| thousandths(i * if over_time { 5 } else { step(number) });
        let (cant, deficiency) = if *zone == 1 { (0, 0) } else { (90, 80) };
        let _ = writeln!(
            table,
            "{name},{},{},{zone},{radius},{direction},{cant},{deficiency},{speed},0.{conicity:03},{country},{line},{site}",
            at(FIRST),
            at(*last)
        );
    }
    write("sections.csv", &table);
    folder
}

/// The rule set, in the campaign that it is for. Triangles are no plausible records of a coach, so
/// rules of plausibility, which the twelfth inherits, are taken away.
fn run(set: &str, by_distance: &Path, by_time: &Path) -> Certification {
    let folder = if BY_TIME.contains(&set) { by_time } else { by_distance };
    let parent = fs::canonicalize(format!("{FOLDER}/{set}.fp")).expect("the rule set");
    let mut text =
        format!("protocol bare \"Without plausibility\"\n  extends  \"{}\"\n", parent.display());
    if set == "12-two-stage" {
        text += "\nremove\n  plausibility  every\n";
    }
    let path = folder.join("bare.fp");
    fs::write(&path, text).expect("written");
    let with = SET.iter().find(|(own, _)| *own == set).map_or(&[][..], |(_, with)| with);
    certified(folder, &path.display().to_string(), with)
        .unwrap_or_else(|problems| panic!("{set}: {}", problems.render(false)))
}

/// What differs, and how many numbers and words were compared.
struct Comparison {
    wrong: Vec<String>,
    compared: usize,
}

impl Comparison {
    fn number(&mut self, what: &str, found: Option<f64>, wanted: &Value) {
        self.compared += 1;
        let wanted = wanted.as_f64();
        let alike = found.zip(wanted).is_some_and(|(found, wanted)| {
            (found - wanted).abs() <= TOLERANCE * wanted.abs().max(1e-3)
        });
        if !alike && found.or(wanted).is_some() {
            self.wrong.push(format!("{what}: {found:?} in place of {wanted:?}"));
        }
    }

    fn same<T: PartialEq + std::fmt::Debug>(&mut self, what: &str, found: T, wanted: T) {
        self.compared += 1;
        if found != wanted {
            self.wrong.push(format!("{what}: {found:?} in place of {wanted:?}"));
        }
    }

    fn values(&mut self, set: &str, quantity: &QuantityResult, wanted: &Value) {
        let words = |key: &str| -> Vec<&str> {
            wanted[key].as_array().expect(key).iter().filter_map(Value::as_str).collect()
        };
        let (sections, positions) = (words("sections"), words("positions"));
        let mut left: BTreeMap<[&str; 2], [&Value; 2]> = BTreeMap::new();
        for (i, section) in sections.iter().enumerate() {
            for (j, position) in positions.iter().enumerate() {
                // A bound of all values is one number.
                let bound = &wanted["bounds"];
                let bound = if bound.is_array() { &bound[i][j] } else { bound };
                left.insert([section, position], [&wanted["values"][i][j], bound]);
            }
        }
        for value in &quantity.values {
            let position = value.signal.rsplit('_').next().unwrap_or_default();
            let what = format!("{set}, {}, {}, {position}", quantity.id, value.section);
            match left.remove(&[value.section.as_str(), position]) {
                Some([wanted, bound]) => {
                    self.number(&what, Some(value.difference), wanted);
                    self.number(&format!("{what}, limit"), value.limit, bound);
                }
                None => self.wrong.push(format!("{what} is new")),
            }
        }
        self.same(&format!("{set}, {}, missing values", quantity.id), left.len(), 0);
    }

    fn limits(&mut self, what: &str, found: &[StatisticResult], wanted: &Value) {
        let wanted = wanted.as_array().expect("limits");
        self.same(&format!("{what}, limits"), found.len(), wanted.len());
        for (found, wanted) in found.iter().zip(wanted) {
            let what = format!("{what}, {} of {}", found.name, found.scope);
            let name = found.name.to_string();
            self.same(&what, Some(name.as_str()), wanted[0].as_str());
            self.same(&what, Some(found.scope.to_string().as_str()), wanted[1].as_str());
            self.number(&what, found.value, &wanted[2]);
            self.number(&format!("{what}, limit"), found.limit, &wanted[3]);
            self.same(&what, found.holds, wanted[4].as_bool());
        }
    }

    fn reports(&mut self, what: &str, found: &[Reported], wanted: &Value) {
        let wanted = wanted.as_array().expect("reports");
        self.same(&format!("{what}, reports"), found.len(), wanted.len());
        for (found, wanted) in found.iter().zip(wanted) {
            let what = format!("{what}, {} of {}", found.name, found.scope);
            let name = found.name.to_string();
            self.same(&what, Some(name.as_str()), wanted[0].as_str());
            self.same(&what, Some(found.scope.to_string().as_str()), wanted[1].as_str());
            self.number(&what, found.value, &wanted[2]);
        }
    }

    fn set(&mut self, set: &str, found: &Certification, wanted: &Value) {
        let quantities = wanted["quantities"].as_object().expect("quantities");
        self.same(&format!("{set}, quantities"), found.quantities.len(), quantities.len());
        for quantity in &found.quantities {
            let what = format!("{set}, {}", quantity.id);
            let Some(wanted) = quantities.get(&quantity.id) else {
                self.wrong.push(format!("{what} is new"));
                continue;
            };
            self.values(set, quantity, wanted);
            self.limits(&what, &quantity.statistics, &wanted["limits"]);
            self.reports(&what, &quantity.reported, &wanted["reports"]);
            self.same(&what, quantity.holds, wanted["holds"].as_bool());
            self.same(&what, quantity.outcome.as_deref(), wanted["outcome"].as_str());
        }
        self.reports(set, &found.reported, &wanted["reports"]);
        self.same(set, Some(found.verdict == Verdict::Validated), wanted["holds"].as_bool());
        self.same(set, found.outcome.as_deref(), wanted["outcome"].as_str());
        let verdicts = wanted["verdicts"].as_object().expect("verdicts");
        self.same(&format!("{set}, verdicts"), found.verdicts.len(), verdicts.len());
        for verdict in &found.verdicts {
            let holds = verdicts.get(&verdict.name).and_then(Value::as_bool);
            let what = format!("{set}, verdict {}", verdict.name);
            self.same(&what, verdict.outcome.holds(), holds);
            self.same(&what, verdict.outcome == Outcome::Open, false);
        }
    }
}

#[test]
fn rule_sets_agree_with_numpy_and_scipy() {
    let (by_distance, by_time) = (campaign(false), campaign(true));
    let text = fs::read_to_string(format!("{FOLDER}/expected.json")).expect("the expected values");
    let expected: BTreeMap<String, Value> = serde_json::from_str(&text).expect("JSON");
    let mut comparison = Comparison { wrong: Vec::new(), compared: 0 };
    for (set, wanted) in &expected {
        let found = run(set, by_distance.path(), by_time.path());
        comparison.set(set, &found, wanted);
    }
    let Comparison { wrong, compared } = comparison;
    assert!(wrong.is_empty(), "{} of {compared}:\n{}", wrong.len(), wrong.join("\n"));
    assert!(expected.len() == 22 && compared > 10_000, "{} sets, {compared}", expected.len());
}
