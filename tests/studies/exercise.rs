//! `exercise`: each pair is certified again from its files, by the protocol as it is and by one with
//! another limit.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;

use crate::common::campaign::{certified, lines};
use crate::common::program::{Ran, fishplate};

/// Limits from above, from below, of a difference, of its spread, with a factor.
const PROTOCOL: &str = r#"protocol pairs "Limits of all kinds"
  author  "A test"
  scope   "A test"
  axis    time in s

parameter most "Largest force"
  default  20 kN
  range    1 kN to 100 kN

channel force "Force"
  in  kN

channel load "Load"
  in  kN

filter SMOOTH "Low-pass"
  step  low-pass 20 Hz, order 2, zero-phase

plausibility live "A channel moves"
  of         force
  require    std >= 0.1 kN
  otherwise  not used

sections
  use      whole records
  minimum  3

quantity largest "Largest force"
  of     force
  from   measured
  value  maximum
  limit  each most

quantity least "Least load"
  of     load
  from   measured
  value  minimum
  limit  each at least 1/4 * 10 kN

quantity level "Mean force"
  of          force
  filter      SMOOTH
  value       mean
  difference  simulated - measured
  limit       mean 0.9 kN
  limit       std 1.1 kN

verdict
  validated  when every limit holds
"#;

const RULES: [&str; 4] = [
    "quantity largest, limit each",
    "quantity least, limit each",
    "quantity level, limit mean",
    "quantity level, limit std",
];

fn campaign() -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = folder.path();
    for (kind, by) in [("measurement", 0.2), ("simulation", 0.0)] {
        fs::create_dir_all(at.join(kind)).expect("a folder");
        for section in 1..=4_u32 {
            let mut text = String::from("time [s],force [kN],load [kN]\n");
            for row in 0..2000 {
                let time = f64::from(row) / 100.0;
                let wave = |frequency: f64| (std::f64::consts::TAU * frequency * time).sin();
                let force = 5.0 + by * f64::from(section) / 4.0 + 2.0 * wave(0.7) + wave(3.1);
                let load = 10.0 + wave(1.3) + by * wave(0.4);
                let _ = writeln!(text, "{time:.2},{force:.6},{load:.6}");
            }
            fs::write(at.join(format!("{kind}/S{section}.csv")), text).expect("written");
        }
    }
    let yaml = "name: Bar\nmeasurement: measurement\nsimulation: simulation\n";
    fs::write(at.join("campaign.yaml"), yaml).expect("written");
    fs::write(at.join("pairs.fp"), PROTOCOL).expect("written");
    folder
}

fn exercise(protocol: &Path, campaign: &Path, out: &Path, more: &[&str]) -> Ran {
    let [protocol, campaign, out] =
        [protocol, campaign, out].map(|path| path.display().to_string());
    let first = ["exercise", &protocol, "--from", &campaign, "--out", &out];
    fishplate(&[&first, more].concat())
}

fn read(out: &Path) -> Value {
    let text = fs::read_to_string(out.join("exercise.json")).expect("exercise.json");
    serde_json::from_str(&text).expect("JSON")
}

/// Which of the rules hold, in their order, and how far the value of one is from its limit.
fn judged(campaign: &Path, protocol: &str, of: usize) -> (Vec<Option<bool>>, f64) {
    let found = certified(campaign, protocol, &[]).expect("it is judged");
    assert_eq!(found.findings, [], "{}", campaign.display());
    let rows: Vec<_> = found.quantities.iter().flat_map(|of| &of.statistics).collect();
    let row = rows[of];
    let (value, limit) = (row.value.expect("a value"), row.limit.expect("a limit"));
    (rows.iter().map(|row| row.holds).collect(), (value.abs() / limit - 1.0).abs())
}

#[test]
fn each_limit_has_a_pair_that_only_it_tells_apart() {
    let base = campaign();
    let folder = tempfile::tempdir().expect("a folder");
    let (protocol, out) = (base.path().join("pairs.fp"), folder.path().join("out"));
    let ran = exercise(&protocol, base.path(), &out, &["--mutate"]);
    assert_eq!(ran.code, 0, "{}{}", ran.stdout, ran.stderr);
    let found = read(&out);
    let limits = found["limits"].as_array().expect("limits");
    assert_eq!(limits.iter().map(|of| &of["limit"]).collect::<Vec<_>>(), RULES, "{found}");
    let text = protocol.display().to_string();
    let other = base.path().join("other.fp");
    // The limit of each pair with one per cent more, or less where it is a lower one.
    let changed =
        [("20 kN", "20.2 kN"), ("1/4", "1/4.04"), ("0.9 kN", "0.909 kN"), ("1.1 kN", "1.111 kN")];
    for (at, of) in limits.iter().enumerate() {
        let pair = out.join(of["pair"]["folder"].as_str().expect("a pair"));
        let (inside, near) = judged(&pair.join("inside"), &text, at);
        assert_eq!(inside, [Some(true); 4], "{of}");
        assert!((1e-6..=1e-3).contains(&near), "{near} {of}");
        let (outside, near) = judged(&pair.join("outside"), &text, at);
        let alone: Vec<Option<bool>> = (0..4).map(|rule| Some(rule != at)).collect();
        assert_eq!(outside, alone, "{of}");
        assert!((1e-6..=1e-3).contains(&near), "{near} {of}");
        let (from, to) = changed[at];
        fs::write(&other, PROTOCOL.replace(from, to)).expect("written");
        let (outside, _) = judged(&pair.join("outside"), &other.display().to_string(), at);
        assert_eq!(outside, [Some(true); 4], "with {to}: {of}");
    }
    mutations(&found);
}

/// Every number of a limit is noticed; the cut-off, the order and the least number of sections are
/// not, since no value comes from them that is near its limit.
fn mutations(found: &Value) {
    let all = found["mutations"].as_array().expect("mutations");
    let of = |noticed: bool| -> Vec<String> {
        let name = |of: &&Value| of["noticed_by"].is_string() == noticed;
        let text =
            |of: &Value| format!("{} {}", of["field"].as_str()?, of["from"].as_str()?).into();
        let mut texts: Vec<String> =
            all.iter().filter(name).filter_map(|of| -> Option<String> { text(of) }).collect();
        texts.dedup();
        texts
    };
    assert_eq!(
        of(true),
        ["default 20", "limit 1", "limit 4", "limit 10", "limit 0.9", "limit 1.1"],
        "{all:?}"
    );
    assert_eq!(of(false), ["step 20", "require 0.1"], "{all:?}");
}

#[test]
fn what_cannot_be_exercised_is_said() {
    let base = campaign();
    let out = tempfile::tempdir().expect("a folder");
    let protocol = base.path().join("other.fp");
    let with = |from: &str, to: &str| {
        assert!(PROTOCOL.contains(from));
        fs::write(&protocol, PROTOCOL.replace(from, to)).expect("written");
    };
    // A limit that the campaign exceeds.
    with("default  20 kN", "default  7 kN");
    let ran = exercise(&protocol, base.path(), out.path(), &[]);
    assert_eq!(ran.code, 2, "{}", ran.stdout);
    assert!(ran.stderr.contains("limits-not-met"), "{}", ran.stderr);
    assert!(ran.stderr.contains("quantity largest, limit each"), "{}", ran.stderr);
    assert!(!out.path().join("exercise.json").exists());
    // Two limits of one value.
    with("limit  each most", "limit  each most\n  limit  maximum most");
    let ran = exercise(&protocol, base.path(), out.path(), &[]);
    assert_eq!(ran.code, 1, "{}{}", ran.stdout, ran.stderr);
    let found = read(out.path());
    for (at, other) in [(0, "quantity largest, limit maximum"), (1, RULES[0])] {
        let of = &found["limits"][at];
        assert_eq!(of["reason"]["why"], "not-alone", "{of}");
        assert_eq!(of["reason"]["others"], serde_json::json!([other]), "{of}");
    }
    // No limit at all.
    let of_limits = |line: &&str| !line.trim_start().starts_with("limit ");
    let none: Vec<&str> = PROTOCOL.lines().filter(of_limits).collect();
    fs::write(&protocol, none.join("\n")).expect("written");
    let ran = exercise(&protocol, base.path(), out.path(), &[]);
    assert!(ran.stdout.contains("states no limit"), "{}{}", ran.stdout, ran.stderr);
    assert_eq!((ran.code, read(out.path())["limits"].as_array().map(Vec::len)), (0, Some(0)));
}

/// The measurement is brought to the simulation at the same places, also where its samples are
/// fewer, and lie between those of the simulation.
#[test]
fn sides_with_other_samples_are_brought_together() {
    let base = campaign();
    let protocol = base.path().join("pairs.fp");
    let from = PROTOCOL.find("  value       mean").expect("the third quantity");
    let to = PROTOCOL.find("verdict").expect("the verdict");
    let metric = "  metric  root-mean-square difference\n  limit   each 0.02 kN\n\n";
    fs::write(&protocol, PROTOCOL[..from].to_string() + metric + &PROTOCOL[to..]).expect("written");
    for section in 1..=4 {
        lines(&base.path().join(format!("measurement/S{section}.csv")), |lines| {
            lines.truncate(1901);
        });
        lines(&base.path().join(format!("simulation/S{section}.csv")), |lines| {
            for (row, line) in lines.iter_mut().enumerate().skip(1) {
                let (_, rest) = line.split_once(',').expect("cells");
                *line = format!("{:.3},{rest}", row as f64 / 100.0 - 0.015);
            }
        });
    }
    let out = tempfile::tempdir().expect("a folder");
    let ran = exercise(&protocol, base.path(), out.path(), &[]);
    assert_eq!(ran.code, 0, "{}{}", ran.stdout, ran.stderr);
    let found = read(out.path());
    // The levels differ by up to 0.2 kN, so that a tenth of it leaves no room.
    assert_eq!(found["gap"], 0.05, "{found}");
    let text = protocol.display().to_string();
    let pair = found["limits"][2]["pair"]["folder"].as_str().expect("a pair");
    for (side, holds) in [("inside", true), ("outside", false)] {
        let (found, _) = judged(&out.path().join(pair).join(side), &text, 2);
        assert_eq!(found, [Some(true), Some(true), Some(holds)]);
    }
}

/// Without a campaign, records are drawn in which all is well; the pairs hold there too.
#[test]
fn records_are_drawn_where_no_campaign_is_given() {
    let folder = tempfile::tempdir().expect("a folder");
    let protocol = folder.path().join("pairs.fp");
    fs::write(&protocol, PROTOCOL).expect("written");
    let (text, out) = (protocol.display().to_string(), folder.path().join("out"));
    let ran = fishplate(&["exercise", &text, "--out", &out.display().to_string()]);
    assert_eq!(ran.code, 0, "{}{}", ran.stdout, ran.stderr);
    let found = read(&out);
    for (at, of) in found["limits"].as_array().expect("limits").iter().enumerate() {
        let pair = out.join(of["pair"]["folder"].as_str().expect("a pair"));
        let (inside, _) = judged(&pair.join("inside"), &text, at);
        let (outside, _) = judged(&pair.join("outside"), &text, at);
        assert_eq!(inside, [Some(true); 4], "{of}");
        assert_eq!(outside, (0..4).map(|rule| Some(rule != at)).collect::<Vec<_>>(), "{of}");
    }
}
