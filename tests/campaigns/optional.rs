//! What a campaign may lack: channels, columns of the table of sections, vehicle data, parameters.
//! What needs them is not assessed, and the rest is.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::campaign::{copy, lines, tiny};
use crate::common::program::{Certified, certify, fishplate};

const RULE_SETS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cases/rule-sets");

/// Something optional of each kind.
const RULES: &str = r#"protocol optional "What may be absent"
  axis  distance in m
  time  time in s

place gear
  members  I, II

channel ay "Lateral acceleration"
  in  m/s^2
  at  each gear

channel roll "Roll angle"
  in        deg
  at        each gear
  optional  not assessed

vehicle mass "Mass of a bogie"
  in        kg
  key       bogie.mass
  optional  not assessed

section route "Route"
  one of    any word
  optional  not assessed

parameter most "Largest scatter"
  optional  not assessed
  range     0.001 m/s^2 to 10 m/s^2

quantity ay_rms "Lateral acceleration, rms value"
  of          ay
  value       rms
  difference  simulated - measured
  limit       mean 1 m/s^2

quantity roll_range "Roll angle, peak to peak"
  from   measured
  of     roll
  value  range
  limit  each 6 deg
"#;

/// The tiny campaign with a protocol of these rules and a change.
fn with(rules: &str, change: impl FnOnce(&Path)) -> Certified {
    let folder = tiny();
    change(folder.path());
    let protocol = folder.path().join("optional.fp");
    fs::write(&protocol, rules).expect("written");
    let protocol = protocol.to_str().expect("a path").to_owned();
    certify(folder.path(), &["--protocol", &protocol, "--only", "results"])
}

fn quantity<'a>(results: &'a Value, id: &str) -> &'a Value {
    let all = results["quantities"].as_array().expect("a list");
    all.iter().find(|one| one["id"] == id).unwrap_or_else(|| panic!("no {id}"))
}

/// The deviations of a kind, as text.
fn deviations(results: &Value, code: &str) -> Vec<String> {
    let all = results["deviations"].as_array().expect("a list").iter();
    let own = all.filter(|one| one["data"]["code"] == code || one["code"] == code);
    own.map(|one| one["says"].as_str().expect("a text").to_owned()).collect()
}

/// A column of each record of a side: a wave of 1 deg.
fn add_roll(campaign: &Path, side: &str, sections: impl Fn(usize) -> bool) {
    for number in (1..=12).filter(|number| sections(*number)) {
        lines(&campaign.join(format!("{side}/S{number:02}.csv")), |lines| {
            for (row, line) in lines.iter_mut().enumerate() {
                let angle = (0.37 * f64::from(u32::try_from(row).expect("few"))).sin();
                let _ = match row {
                    0 => write!(line, ",roll_I [deg],roll_II [deg]"),
                    _ => write!(line, ",{angle:.5},{:.5}", -angle),
                };
            }
        });
    }
}

/// A channel that no record has leaves its quantity without values and the verdict to the others.
/// Beside the verdict stands that it does not speak of the quantity.
#[test]
fn a_quantity_without_its_channel_is_not_assessed() {
    let found = with(RULES, |_| {});
    assert_eq!(found.ran.code, 0, "{}{}", found.ran.stdout, found.ran.stderr);
    let results = found.results();
    assert_eq!(quantity(&results, "ay_rms")["holds"], true);
    let roll = quantity(&results, "roll_range");
    assert_eq!((&roll["holds"], &roll["pairs"]), (&Value::Null, &0.into()));
    let reason = "the optional channel `roll` was not recorded: `roll_I` and `roll_II` are in no record of the measurement";
    assert_eq!(roll["reason"], reason);
    assert_eq!(
        deviations(&results, "not-assessed"),
        [format!("roll_range is not assessed: {reason}.")]
    );
    assert!(
        found.ran.stdout.contains("requirements met, 1 quantity not assessed"),
        "{}",
        found.ran.stdout
    );
}

/// A header with a slip makes a channel absent: the reason names the column.
#[test]
fn the_nearest_column_is_named() {
    let found = with(RULES, |campaign| {
        for number in 1..=12 {
            lines(&campaign.join(format!("measurement/S{number:02}.csv")), |lines| {
                lines[0] += ",Roll_I [deg]";
                lines[1..].iter_mut().for_each(|line| *line += ",0.5");
            });
        }
    });
    let roll = found.results();
    let reason = quantity(&roll, "roll_range")["reason"].as_str().expect("a reason").to_owned();
    assert!(reason.ends_with("(there is `Roll_I`)"), "{reason}");
}

/// A channel of one side is absent for what reads the other side, and there for what reads its own;
/// one of some records is a fault of the other sections.
#[test]
fn a_channel_of_some_records_is_not_absent() {
    let of_both = RULES.replace("  from   measured\n  of     roll\n  value  range\n  limit  each 6 deg", "  of          roll\n  value       range\n  difference  simulated - measured\n  limit       mean 6 deg");
    let simulated = |campaign: &Path| add_roll(campaign, "simulation", |_| true);
    let results = with(&of_both, simulated).results();
    let reason = quantity(&results, "roll_range")["reason"].as_str().expect("a reason").to_owned();
    assert!(reason.ends_with("in no record of the measurement"), "{reason}");

    let found = with(RULES, |campaign| add_roll(campaign, "measurement", |_| true)).results();
    let roll = quantity(&found, "roll_range");
    assert_eq!((&roll["holds"], &roll["pairs"]), (&true.into(), &24.into()));

    let found = with(RULES, |campaign| add_roll(campaign, "measurement", |number| number > 3));
    let results = found.results();
    let unused: Vec<&Value> = results["sections"]
        .as_array()
        .expect("a list")
        .iter()
        .filter(|section| section["used"] == false)
        .map(|section| &section["section"])
        .collect();
    assert_eq!(unused, ["S01", "S02", "S03"]);
    assert_eq!(quantity(&results, "roll_range")["pairs"], 18);
}

/// `not assessable` leaves the numbers of the others and no verdict; so does a protocol of which
/// nothing can be assessed.
#[test]
fn what_bars_the_verdict() {
    let strict = RULES
        .replace("each gear\n  optional  not assessed", "each gear\n  optional  not assessable");
    let results = with(&strict, |_| {}).results();
    assert_eq!(quantity(&results, "ay_rms")["holds"], true);
    assert_eq!(results["verdict"], "not assessable");
    assert!(results["reasons"][0].as_str().is_some_and(|says| says.contains("`roll`")));

    let start = RULES.find("quantity ay_rms").expect("there");
    let end = RULES.find("quantity roll_range").expect("there");
    let alone = [&RULES[..start], &RULES[end..]].concat();
    let found = with(&alone, |_| {});
    assert_eq!((found.ran.code, &found.results()["verdict"]), (1, &"not assessable".into()));
}

/// Where only a limit needs what is absent, the others count: one that is not met fails.
#[test]
fn a_limit_alone_is_not_assessed() {
    let limits = "  limit       mean 1 m/s^2\n";
    for needs in [
        "std 1 m/s^2 * (mass / (1000 kg))",
        "std most",
        "std 1 m/s^2 for each route",
        "std 1 m/s^2 for sections where route is north",
    ] {
        let rules = RULES.replace(limits, &format!("{limits}  limit       {needs}\n"));
        let results = with(&rules, |_| {}).results();
        assert_eq!(results["verdict"], "requirements met", "{needs}: {}", results["reasons"]);
        assert_eq!(deviations(&results, "not-assessed").len(), 2, "{needs}");
        let ay = quantity(&results, "ay_rms");
        let holds: Vec<&Value> =
            ay["statistics"].as_array().expect("a list").iter().map(|one| &one["holds"]).collect();
        assert_eq!(holds, [&Value::Bool(true), &Value::Null], "{needs}");

        let failing = rules.replace("mean 1 m/s^2", "mean 0.000001 m/s^2");
        let results = with(&failing, |_| {}).results();
        assert_eq!(results["verdict"], "requirements not met", "{needs}");
        assert_eq!(quantity(&results, "ay_rms")["holds"], false, "{needs}");
    }
}

/// A rule by numbers cannot be given where what is not assessed could make it hold.
#[test]
fn at_least_so_many_of_what_is_assessed() {
    let rule = |count: usize| {
        format!("{RULES}\nverdict\n  validated  when at least {count} quantities hold\n")
    };
    assert_eq!(with(&rule(1), |_| {}).results()["verdict"], "requirements met");
    assert_eq!(with(&rule(2), |_| {}).results()["verdict"], "not assessable");
}

/// Checks and plausibility rules that need the channel are told as not checked, and bar nothing.
#[test]
fn checks_and_plausibility_are_told() {
    let rules = format!(
        "{RULES}\ncheck calm \"Little roll\"\n  require  range of roll at gear I <= 9 deg\n\nplausibility sized \"Size of the roll angle\"\n  of       roll\n  require  maximum <= 45 deg\n"
    );
    let found = with(&rules, |_| {});
    let results = found.results();
    assert_eq!(results["verdict"], "requirements met", "{}", found.ran.stdout);
    let [check] = &deviations(&results, "unchecked")[..] else { panic!("{}", found.ran.stdout) };
    assert!(check.starts_with("Little roll: the optional channel `roll`"), "{check}");
    let [rule] = &deviations(&results, "rules-not-checked")[..] else {
        panic!("{}", found.ran.stdout)
    };
    assert!(rule.starts_with("Not checked: Size of the roll angle: "), "{rule}");
    let found = with(&rules, |campaign| {
        add_roll(campaign, "measurement", |_| true);
        add_roll(campaign, "simulation", |_| true);
    });
    let results = found.results();
    assert!(deviations(&results, "unchecked").is_empty());
    assert_eq!(results["sections"][0]["checks"][0]["holds"], true);
}

/// A result with something not assessed follows from its own values.
#[test]
fn verify_comes_to_the_same() {
    let folder = tiny();
    let protocol = folder.path().join("optional.fp");
    fs::write(
        &protocol,
        RULES.replace("mean 1 m/s^2", "mean 1 m/s^2\n  limit       std 1 m/s^2 for each route"),
    )
    .expect("written");
    let out = folder.path().join("out");
    let path = |path: &Path| path.to_str().expect("a path").to_owned();
    let ran = fishplate(&[
        "certify",
        &path(folder.path()),
        "--protocol",
        &path(&protocol),
        "--out",
        &path(&out),
    ]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let ran = fishplate(&["verify", &path(&out.join("report.pdf")), "--report-only"]);
    assert_eq!(ran.code, 0, "{}{}", ran.stdout, ran.stderr);
    let html = fs::read_to_string(out.join("report.html")).expect("written");
    assert!(html.contains("not assessed") && html.contains("was not recorded"));
}

/// Rules in the manner of AAR M-1001 on a campaign without a roll angle.
#[test]
fn the_rules_of_freight_cars_without_a_roll_angle() {
    let campaign = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/coach-good"));
    let protocol = format!("{RULE_SETS}/01-aar-m1001.fp");
    let found = certify(campaign, &["--protocol", &protocol, "--only", "results"]);
    let results = found.results();
    for id in ["single_wheel", "axle_sum", "axle_sum_mean", "axle_sum_3ft", "min_load"] {
        assert!(quantity(&results, id)["holds"].is_boolean(), "{id}");
    }
    assert_eq!(quantity(&results, "roll_pp")["holds"], Value::Null);
    assert_eq!(results["verdicts"][0]["name"], "forces");
    assert_ne!(results["verdicts"][0]["outcome"], "not assessable");
    assert_eq!(results["verdicts"][1]["outcome"], "not assessable");
    assert_eq!(deviations(&results, "not-assessed").len(), 1);
}

/// A variant of a shipped protocol with a channel that records may lack asks for less, and its
/// study leaves out what is not assessed.
#[test]
fn a_variant_with_something_optional_asks_for_less() {
    const VARIANT: &str = r#"protocol variant "A variant"
  extends  en14363-2016-annex-t

channel ay
  optional  not assessed

channel roll "Roll angle"
  in        deg
  at        each running_gear
  optional  not assessed

quantity roll_range "Roll angle, peak to peak"
  of          roll
  value       range
  difference  signed
  limit       std 1 deg
"#;
    let folder = tiny();
    let protocol = folder.path().join("variant.fp");
    fs::write(&protocol, VARIANT).expect("written");
    let path = |path: &Path| path.to_str().expect("a path").to_owned();
    let protocol = path(&protocol);
    let found = certify(folder.path(), &["--protocol", &protocol, "--only", "results"]);
    let results = found.results();
    assert_eq!(results["verdict"], "validated", "{}", found.ran.stdout);
    let relaxed = results["protocol"]["own"]["relaxed"].as_array().expect("a list");
    assert!(
        relaxed.iter().any(|rule| rule.as_str().is_some_and(|rule| rule.contains("ay"))),
        "{relaxed:?}"
    );

    let out = folder.path().join("study");
    let ran = fishplate(&[
        "study",
        "sections",
        &path(folder.path()),
        "--protocol",
        &protocol,
        "--out",
        &path(&out),
    ]);
    assert!(ran.code < 2, "{}", ran.stderr);
    let study = fs::read_to_string(out.join("study.json")).expect("written");
    let study: Value = serde_json::from_str(&study).expect("JSON");
    assert_eq!(study["share_validated"], 1.0, "{}", ran.stdout);
}

/// Countries and lines that the protocol does not list.
#[test]
fn strata_of_any_word() {
    let folder = copy(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/coach-good")));
    lines(&folder.path().join("sections.csv"), |lines| {
        lines[0] += ",country,line";
        for (row, line) in lines.iter_mut().enumerate().skip(1) {
            *line += [",AT,Semmering", ",IT,Brenner"][row % 2];
        }
    });
    let protocol = format!("{RULE_SETS}/21-country.fp");
    let found = certify(folder.path(), &["--protocol", &protocol, "--only", "results"]);
    let results = found.results();
    let keys = |one: &Value| (one["keys"]["country"].clone(), one["keys"]["line"].clone());
    let groups: Vec<_> = results["reported"].as_array().expect("a list").iter().map(keys).collect();
    assert!(groups.contains(&("AT".into(), "Semmering".into())), "{groups:?}");
    assert!(groups.contains(&("IT".into(), "Brenner".into())), "{groups:?}");
    // 13 sections, of which every second from the first on is in Italy.
    let share = results["reported"][0]["value"].as_f64().expect("a share");
    assert!((share - 7.0 / 13.0).abs() < 1e-9, "{share}");
}
