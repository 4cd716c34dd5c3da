//! `study margin` against closed forms, and changed channels against records that were written so.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use fishplate::certify::{Compiled, compile};
use fishplate::check::{Overrides, family};
use fishplate::data::Campaign;
use fishplate::library;
use fishplate::problem::Problems;
use fishplate::result::QuantityResult;
use fishplate::run::{Change, Line, Lines, hold};
use serde_json::Value;
use tempfile::TempDir;

use crate::common::campaign::{certified, write_tiny};
use crate::common::program::{Ran, fishplate};

/// Two forces at two ends of a bar; the mean of one, and the mean of their ratio.
const PROTOCOL: &str = r#"protocol closed-forms "Margins that are known"
  author  "A test"
  scope   "A test"
  axis    time in s

parameter share "A number that the verdict depends on"
  default  1
  range    0.1 to 2

parameter size "A choice that the verdict depends on"
  default  plain
  one of   plain, twofold, half

place end
  members  a, b

channel force "Force"
  in      kN
  at      each end
  column  "force_{end}"

channel other "Other force"
  in  kN

channel load "Load"
  in  kN

signal quotient "Ratio"
  is  load / other
  in  -

define sized "Mean, times a factor"
  is  mean when size is plain, 2 * mean when size is twofold, otherwise mean / 2

sections
  use      whole records
  minimum  1

quantity mean_force "Mean force"
  of          force at every end
  value       sized
  difference  simulated - measured
  limit       mean share * 1 kN

quantity ratio "Mean of a ratio"
  of          quotient
  value       mean
  difference  simulated - measured
  limit       mean 0.2

verdict
  validated  when every limit holds
"#;

/// Means of the measured channels; those of the simulation are 10 kN, 4 kN and 8 kN.
#[derive(Clone, Copy)]
struct Means {
    force: f64,
    other: f64,
    load: f64,
}

const NEAR: Means = Means { force: 10.4, other: 4.0, load: 8.0 };

fn campaign(means: Means, more: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = folder.path();
    for (kind, of) in
        [("measurement", means), ("simulation", Means { force: 10.0, other: 4.0, load: 8.0 })]
    {
        fs::create_dir_all(at.join(kind)).expect("a folder");
        for section in 1..=3 {
            let mut text =
                String::from("time [s],force_a [kN],force_b [kN],other [kN],load [kN]\n");
            for row in 0..400 {
                // A whole number of waves, whose mean is zero; other ones in each record.
                let turn = std::f64::consts::TAU * f64::from(row) / 400.0;
                let wave = (f64::from(section) * turn).sin() + 0.3 * (7.0 * turn).cos();
                let (a, b) = (of.force + wave, of.force - 0.5 * wave);
                let time = f64::from(row) / 200.0;
                let _ = writeln!(text, "{time:.3},{a:.9},{b:.9},{},{}", of.other, of.load);
            }
            fs::write(at.join(format!("{kind}/S{section}.csv")), text).expect("written");
        }
    }
    let yaml = format!(
        "name: Bar\nmeasurement: measurement\nsimulation: simulation\nprotocol: protocol.fp\n{more}"
    );
    fs::write(at.join("campaign.yaml"), yaml).expect("written");
    fs::write(at.join("protocol.fp"), PROTOCOL).expect("written");
    folder
}

fn study(campaign: &Path, out: &Path, more: &[&str]) -> Ran {
    let (campaign, out) = (campaign.display().to_string(), out.display().to_string());
    let first = ["study", "margin", &campaign, "--quiet", "--out", &out];
    fishplate(&[&first, more].concat())
}

fn found(campaign: &Path, more: &[&str]) -> Value {
    let out = tempfile::tempdir().expect("a folder");
    let ran = study(campaign, out.path(), more);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    serde_json::from_str(&fs::read_to_string(out.path().join("study.json")).expect("a file"))
        .expect("JSON")
}

fn margin<'a>(study: &'a Value, change: &str, of: &str) -> &'a Value {
    let all = study["margin"].as_array().expect("margins");
    all.iter()
        .find(|one| one["change"] == change && one["of"] == of)
        .unwrap_or_else(|| panic!("no margin of {change} of {of}: {all:?}"))
}

/// Searched margins end where the verdict stays, 0.1 % of the change before the flip.
#[track_caller]
fn ends(margin: &Value, low: Option<f64>, high: Option<f64>) {
    for (key, expected) in [("low", low), ("high", high)] {
        let found = margin[key].as_f64();
        let near = match (found, expected) {
            (Some(found), Some(expected)) => {
                let step = margin["searched"]["step"].as_f64().unwrap_or(0.0);
                let inside = (expected - found) * expected.signum();
                (-1e-9..=1.1e-3 * expected.abs().max(step)).contains(&inside)
            }
            (found, expected) => found == expected,
        };
        assert!(near, "{key}: {found:?}, expected {expected:?} in {margin}");
    }
}

/// The mean difference is 10 - 10.4 (1 + g) - o = -0.4 - 10.4 g - o, and its limit 1 kN; that of
/// the ratio is 2 - 2 (1 + g) = -2 g for a gain of the load, and 2 - 2 / (1 + g) for one of the
/// other force, with the limit 0.2.
#[test]
fn margins_agree_with_closed_forms() {
    let campaign = campaign(NEAR, "");
    let study = found(campaign.path(), &[]);
    assert_eq!(study["verdict"], "validated");
    assert_eq!(study["probability_right"], Value::Null);
    let gain = margin(&study, "gain", "force");
    ends(gain, Some(-100.0 * 1.4 / 10.4), Some(100.0 * 0.6 / 10.4));
    assert_eq!(gain["columns"], serde_json::json!(["force_a", "force_b"]));
    assert_eq!((&gain["exact"], &gain["unit"]), (&Value::Bool(false), &"%".into()));
    ends(margin(&study, "offset", "force"), Some(-1.4), Some(0.6));
    ends(margin(&study, "gain", "load"), Some(-10.0), Some(10.0));
    let [below, above] = [2.0 / 2.2, 2.0 / 1.8].map(|factor| 100.0 * (factor - 1.0));
    ends(margin(&study, "gain", "other"), Some(below), Some(above));
    // The ratio with an offset of its divisor is not a straight line: 2 - 8 / (4 + o).
    let [below, above] = [8.0 / 2.2 - 4.0, 8.0 / 1.8 - 4.0];
    ends(margin(&study, "offset", "other"), Some(below), Some(above));
    // From the estimates: 0.4 of 1 kN; the ratio has no difference at all.
    let limit = margin(&study, "limit", "mean of mean_force");
    assert!((limit["low"].as_f64().expect("a flip") + 60.0).abs() < 1e-9, "{limit}");
    assert_eq!((&limit["high"], &limit["exact"]), (&Value::Null, &Value::Bool(true)));
    let share = margin(&study, "parameter", "share")["low"].as_f64().expect("a flip");
    assert!((0.4..0.4 + 1e-3 * 0.6).contains(&share), "{share}");
}

/// Each edge is moved by itself: -0.4 kN is a fifth of the lower one, 0.3 kN three fifths of the upper
/// one, and -2.5 kN lies a quarter beyond the lower one.
#[test]
fn each_edge_of_a_limit_has_its_margin() {
    let of = |force: f64, edge: &str| {
        let campaign = campaign(Means { force, ..NEAR }, "");
        let edges = "limit       mean between -2 kN * share and 0.5 kN";
        let text = PROTOCOL.replace("limit       mean share * 1 kN", edges);
        fs::write(campaign.path().join("protocol.fp"), text).expect("written");
        let study = found(campaign.path(), &[]);
        let margin = margin(&study, "limit", &format!("mean of mean_force, {edge} edge"));
        [&margin["low"], &margin["high"]]
            .map(|end| end.as_f64().map(|end| (1e6 * end).round() / 1e6))
    };
    assert_eq!(of(10.4, "lower"), [Some(-80.0), None]);
    assert_eq!(of(9.7, "upper"), [Some(-40.0), None]);
    assert_eq!(of(12.5, "lower"), [None, Some(25.0)]);
    // What meets neither edge by moving the other one.
    assert_eq!(of(9.0, "upper"), [None, Some(100.0)]);
}

#[test]
fn choices_that_flip_the_verdict_are_named() {
    let near = campaign(NEAR, "");
    let study = found(near.path(), &[]);
    let rule = margin(&study, "parameter", "size");
    assert_eq!((&rule["flips_with"], &rule["tried"]), (&Value::Null, &2.into()));
    // -1.4 kN does not meet the limit, half of it does.
    let far = campaign(Means { force: 11.4, ..NEAR }, "");
    let study = found(far.path(), &[]);
    assert_eq!(study["verdict"], "not validated");
    let rule = margin(&study, "parameter", "size");
    assert_eq!(rule["flips_with"], serde_json::json!(["half"]));
    let limit = margin(&study, "limit", "mean of mean_force");
    assert!((limit["high"].as_f64().expect("a flip") - 40.0).abs() < 1e-9, "{limit}");
    // Not monotone: with -0.4 to -2.4 kN it is validated, farther it is not again.
    let offset = margin(&study, "offset", "force");
    ends(offset, Some(-0.4), None);
    assert_eq!(offset["verdict_low"], "validated");
}

/// The standard normal distribution up to x: (1 + erf(x / sqrt(2))) / 2 by `math.erf` of Python.
const NORMAL: [(f64, f64); 5] = [
    (1.2, 0.884_930_329_778_291_7),
    (-2.8, 0.002_555_130_330_427_924),
    (1.697_056_274_847_714, 0.955_156_989_114_817_7),
    (-3.959_797_974_644_666, 0.000_037_506_597_332_7),
    (2.5, 0.993_790_334_674_223_8),
];

fn below(x: f64) -> f64 {
    let known = NORMAL.iter().find(|(known, _)| (known - x).abs() < 1e-9);
    known.unwrap_or_else(|| panic!("{x} is not in the table")).1
}

/// Draws of the tests; the share of them is known to 0.5 / sqrt(4000) = 0.008.
const DRAWS: [&str; 2] = ["--draws", "4000"];
const ROOM: f64 = 4.0 * 0.008;

#[track_caller]
fn probable(study: &Value, expected: f64) {
    let share = study["probability_right"].as_f64().expect("a share");
    let [low, high] = [0, 1].map(|at| {
        study["probability"]["interval_95"][at].as_f64().expect("an end of the interval")
    });
    assert!((share - expected).abs() < ROOM, "{share} instead of {expected}");
    assert!(low <= share && share <= high && high - low < ROOM, "{low} {share} {high}");
}

/// With an offset of the standard uncertainty u, the difference is normal with mean -0.4 kN and
/// standard deviation u; of two ends with errors of their own, u / sqrt(2).
#[test]
fn the_probability_is_that_of_the_normal_distribution() {
    let shared = "uncertainty:\n  force: {expanded: 1 kN, k: 2}\n";
    let study = found(campaign(NEAR, shared).path(), &DRAWS);
    probable(&study, below(1.2) - below(-2.8));
    let risk = &study["probability"]["limits"][0];
    assert_eq!(risk["risk_of"], "false acceptance");
    let wrong = 1.0 - (below(1.2) - below(-2.8));
    assert!((risk["risk"].as_f64().expect("a risk") - wrong).abs() < ROOM);
    // 5 % of u is more than four standard deviations of one that is estimated from 4000 draws.
    let uncertainty = risk["standard_uncertainty"].as_f64().expect("a number");
    assert!((uncertainty - 0.5).abs() < 0.025, "{uncertainty}");
    // 0.6 kN from the limit, and 1.645 * 0.5 kN are 0.82 kN.
    assert_eq!(risk["within_guard_band"], true);
    let own = "uncertainty:\n  correlated: false\n  force: {standard: 0.5 kN}\n";
    let study = found(campaign(NEAR, own).path(), &DRAWS);
    let root = 2.0_f64.sqrt();
    probable(&study, below(1.2 * root) - below(-2.8 * root));
}

/// The difference of the ratio is -2 g: with a standard uncertainty of 4 % it meets 0.2 as long as g
/// is within 2.5 standard deviations.
#[test]
fn the_probability_of_a_ratio_follows_from_the_gain() {
    let gain = "uncertainty:\n  load: {standard: 4 %}\n  unread: {standard: 1 %}\n";
    let study = found(campaign(NEAR, gain).path(), &DRAWS);
    probable(&study, 2.0 * below(2.5) - 1.0);
    assert!(study["notes"].to_string().contains("`unread` is not used"), "{}", study["notes"]);
}

#[test]
fn a_study_is_the_same_on_any_number_of_cores_and_other_with_another_seed() {
    let campaign = campaign(NEAR, "uncertainty:\n  force: {standard: 3 %}\n");
    let out = tempfile::tempdir().expect("a folder");
    let of = |name: &str, more: &[&str]| {
        let folder = out.path().join(name);
        let ran = study(campaign.path(), &folder, &[more, &["--draws", "300"]].concat());
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        let files =
            ["study.json", "report.pdf", "report.html", "tables/margin.csv", "tables/risks.csv"];
        files.map(|file| fs::read(folder.join(file)).expect("a written file"))
    };
    let one = of("one", &["--jobs", "1"]);
    assert!(one == of("two", &["--jobs", "2"]), "two cores give another study");
    assert!(one[0] != of("other", &["--seed", "7"])[0], "another seed gives the same study");
    let html = String::from_utf8_lossy(&one[2]).into_owned();
    assert!(html.contains("gains of force within") && !html.contains("NaN"), "the opening");
}

#[test]
fn uncertainties_that_contradict_are_refused_with_both_places() {
    let declared = "declared_tolerances:\n  force offset [N]: 700\n  channel gain [-]: 0.01\n";
    let refused = |more: &str| {
        let out = tempfile::tempdir().expect("a folder");
        let ran = study(campaign(NEAR, more).path(), out.path(), &[]);
        assert_eq!(ran.code, 2, "{}", ran.stderr);
        ran.stderr
    };
    let said = refused(&format!("{declared}uncertainty:\n  force: {{expanded: 1 kN, k: 2}}\n"));
    assert!(said.contains("uncertainty-contradiction") && said.contains("declared here"), "{said}");
    assert!(said.contains("campaign.yaml:9"), "{said}");
    let said = refused(&format!("{declared}uncertainty:\n  force: {{standard: 2 %}}\n"));
    assert!(said.contains("`channel gain`"), "{said}");
    // The same number in another unit is no contradiction.
    let same = format!("{declared}uncertainty:\n  force: {{expanded: 1.4 kN, k: 2}}\n");
    assert!(found(campaign(NEAR, &same).path(), &["--draws", "50"])["probability"].is_object());
    for (uncertainty, code) in [
        ("{expanded: 1 kN}", "uncertainty-coverage"),
        ("{expanded: 1 kN, k: 0}", "uncertainty-coverage"),
        ("{standard: 1 kN, k: 2}", "uncertainty-coverage"),
        ("{k: 2}", "key-missing"),
        ("{standard: 1}", "wrong-kind"),
        ("{standard: 1 m}", "unit-mismatch"),
        ("[{standard: 1 kN}, {standard: 2 kN}]", "uncertainty-twice"),
    ] {
        let said = refused(&format!("uncertainty:\n  force: {uncertainty}\n"));
        assert!(said.contains(code) && said.contains("campaign.yaml:6"), "{uncertainty}: {said}");
    }
}

fn shipped(name: &str) -> Compiled {
    let mut problems = Problems::default();
    let source = library::find(name, None).expect("a shipped protocol");
    let family = family::read(&source, &library::parent, &mut problems);
    compile(family, &Overrides::new(), &mut problems).expect("a protocol")
}

/// Values and statistics of quantities, in order.
fn numbers(quantities: &[QuantityResult]) -> Vec<(String, f64)> {
    let of = |quantity: &QuantityResult| {
        let values = quantity.values.iter().map(|value| {
            (format!("{} {} {}", quantity.id, value.section, value.signal), value.difference)
        });
        let statistics = quantity
            .statistics
            .iter()
            .filter_map(|one| Some((format!("{} {}", quantity.id, one.name), one.value?)));
        values.chain(statistics).collect::<Vec<_>>()
    };
    quantities.iter().flat_map(of).collect()
}

/// Multiplies the columns of a channel in all measured records and adds to them.
fn rewrite(folder: &Path, lines: &[(&str, f64, f64)]) {
    let records = fs::read_dir(folder.join("measurement")).expect("a folder");
    for path in records.map(|entry| entry.expect("readable").path()).collect::<Vec<PathBuf>>() {
        let text = fs::read_to_string(&path).expect("text");
        let mut rows = text.lines();
        let heading = rows.next().expect("a heading");
        let names: Vec<&str> = heading.split(',').collect();
        let cell = |(at, cell): (usize, &str)| {
            let line = lines.iter().find(|(column, ..)| names[at].starts_with(column));
            line.map_or_else(
                || cell.to_owned(),
                |(_, factor, offset)| {
                    (factor * cell.parse::<f64>().expect("a number") + offset).to_string()
                },
            )
        };
        let row =
            |row: &str| row.split(',').enumerate().map(cell).collect::<Vec<String>>().join(",");
        let changed: Vec<String> =
            std::iter::once(heading.to_owned()).chain(rows.map(row)).collect();
        fs::write(&path, changed.join("\n") + "\n").expect("written");
    }
}

/// Gains, offsets and both, of one channel and of several, alike and not alike at the positions:
/// every value is that of records which were written so, to the rounding of sums.
#[test]
fn changed_channels_are_as_if_they_were_recorded_so() {
    const PROTOCOL: &str = "en14363-2016-annex-t";
    let (folder, again) = (tempfile::tempdir().expect("a folder"), |lines: &[_]| {
        let other = tempfile::tempdir().expect("a folder");
        write_tiny(other.path());
        rewrite(other.path(), lines);
        certified(other.path(), PROTOCOL, &[]).expect("a certification")
    });
    write_tiny(folder.path());
    let compiled = shipped(PROTOCOL);
    let mut problems = Problems::default();
    let campaign = Campaign::open(folder.path(), &mut problems).expect("a campaign");
    let cases: [&[(&str, f64, f64)]; 4] = [
        &[("Y_", 1.07, 0.0), ("Q_", 0.98, 0.0)],
        &[("Y_", 1.0, 0.4), ("ay_", 0.9, 0.02)],
        &[("Y_1R", 1.03, 0.0), ("Q_3L", 1.0, -0.7)],
        &[("az_I ", 1.2, -0.1)],
    ];
    let columns = |prefix: &str| -> Vec<String> {
        let wheels = ["1R", "1L", "3R", "3L"];
        let all = ["Y", "Q"].iter().flat_map(|name| wheels.map(|wheel| format!("{name}_{wheel}")));
        let all = all.chain(["ay_I", "ay_II", "az_I", "az_II"].map(String::from));
        all.filter(|name| format!("{name} ").starts_with(prefix)).collect()
    };
    let Compiled { plan, graph, .. } = &compiled;
    let (_, found) = hold(plan, graph, (&campaign).into(), true, &|_| {}, |holding| {
        cases.map(|case| {
            let mut lines = Lines::new();
            for (prefix, factor, offset) in case {
                // Offsets are in kN and m/s^2 here, in SI there.
                let unit = if prefix.starts_with('a') { 1.0 } else { 1000.0 };
                let line = Line { factor: *factor, offset: offset * unit };
                lines.extend(columns(prefix).into_iter().map(|name| (name, line)));
            }
            holding.with(Change::Calibrated(&lines)).judge(plan).quantities
        })
    })
    .expect("held");
    for (case, found) in cases.iter().zip(found) {
        let (found, expected) = (numbers(&found), numbers(&again(case).quantities));
        assert!(expected.len() > 200, "{}", expected.len());
        assert_eq!(found.len(), expected.len());
        for ((name, found), (_, expected)) in found.iter().zip(&expected) {
            // Values are up to 60 kN.
            assert!((found - expected).abs() < 1e-9 * 60.0, "{case:?} {name}: {found} {expected}");
        }
    }
}
