//! `explain --stage needs` lists what a run reads: no less, and nothing more is required.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::common::campaign::{copy, lines, tiny};
use crate::common::program::{certify, fishplate};
use serde_json::Value;

const PROTOCOL: &str = "en14363-2016-annex-t";
const RESULTS: [&str; 2] = ["--only", "results"];

fn needs() -> Value {
    let ran = fishplate(&["explain", PROTOCOL, "--stage", "needs", "--format", "json"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    serde_json::from_str(&ran.stdout).expect("JSON")
}

/// Names of what is required in a list.
fn required(list: &Value, of: impl Fn(&Value) -> bool) -> BTreeSet<String> {
    let all = list.as_array().expect("a list").iter();
    all.filter(|need| need["required"] == true && of(need))
        .map(|need| need["name"].as_str().expect("a name").to_string())
        .collect()
}

/// Keeps the columns of a table that satisfy a condition.
fn keep(path: &Path, kept: impl Fn(&str) -> bool) {
    lines(path, |lines| {
        let name = |heading: &str| heading.split(" [").next().unwrap_or_default().to_string();
        let keep: Vec<bool> = lines[0].split(',').map(|heading| kept(&name(heading))).collect();
        for line in lines.iter_mut() {
            let cells: Vec<&str> = line
                .split(',')
                .zip(&keep)
                .filter(|(_, keep)| **keep)
                .map(|(cell, _)| cell)
                .collect();
            *line = cells.join(",");
        }
    });
}

fn keep_in_records(campaign: &Path, folder: &str, kept: impl Fn(&str) -> bool) {
    for entry in fs::read_dir(campaign.join(folder)).expect("a folder") {
        keep(&entry.expect("readable").path(), &kept);
    }
}

/// Folder of the records of a side.
const SIDES: [(&str, &str); 2] = [("simulated", "simulation"), ("measured", "measurement")];

/// Removes all that is not required from a campaign.
fn cut_down(campaign: &Path, needs: &Value) {
    for (side, folder) in SIDES {
        let channels = required(&needs["channels"], |need| need["record"] == side);
        keep_in_records(campaign, folder, |name| channels.contains(name));
    }
    let columns = required(&needs["sections"], |_| true);
    keep(&campaign.join("sections.csv"), |name| columns.contains(name));
    let vehicle = required(&needs["vehicle"], |_| true);
    lines(&campaign.join("vehicle.yaml"), |lines| {
        lines.retain(|line| vehicle.contains(line.split(':').next().unwrap_or_default()))
    });
}

#[test]
fn what_is_required_is_enough_for_the_same_numbers() {
    let (needs, campaign) = (needs(), tiny());
    // More than is needed: columns and vehicle data that no rule reads.
    let add = |path: &Path, heading: &str, cell: &str| {
        lines(path, |lines| {
            lines.iter_mut().enumerate().for_each(|(row, line)| {
                *line += &format!(",{}", if row == 0 { heading } else { cell })
            })
        });
    };
    add(&campaign.path().join("sections.csv"), "weather", "dry");
    add(&campaign.path().join("simulation/S01.csv"), "spare [kN]", "1");
    let whole = certify(campaign.path(), &RESULTS);
    let before = fs::read_to_string(campaign.path().join("simulation/S01.csv")).expect("readable");
    cut_down(campaign.path(), &needs);
    let after = fs::read_to_string(campaign.path().join("simulation/S01.csv")).expect("readable");
    assert!(after.len() < before.len());
    let cut = certify(campaign.path(), &RESULTS);
    assert_eq!((whole.ran.code, cut.ran.code), (0, 0), "{}{}", whole.ran.stderr, cut.ran.stderr);
    let (whole, cut) = (whole.results(), cut.results());
    assert_eq!(whole["quantities"], cut["quantities"]);
    assert_eq!(whole["zones"], cut["zones"]);
    assert!(whole["quantities"].as_array().is_some_and(|quantities| quantities.len() == 12));
}

#[test]
fn nothing_that_is_required_can_be_missing_unnoticed() {
    let (needs, campaign) = (needs(), tiny());
    cut_down(campaign.path(), &needs);
    let told = |what: &str, remove: &dyn Fn(&Path)| {
        let campaign = copy(campaign.path());
        remove(campaign.path());
        let found = certify(campaign.path(), &RESULTS);
        let results = if found.ran.code == 2 { String::new() } else { found.results().to_string() };
        let said = format!("{}{}{results}", found.ran.stdout, found.ran.stderr);
        assert!(
            said.contains(&format!("`{what}`")),
            "{what} (exit code {}): {said}",
            found.ran.code
        );
    };
    let mut count = 0;
    for (side, folder) in SIDES {
        for channel in required(&needs["channels"], |need| need["record"] == side) {
            told(&channel, &|campaign| keep_in_records(campaign, folder, |name| name != channel));
            count += 1;
        }
    }
    for column in required(&needs["sections"], |need| need["name"] != "section") {
        told(&column, &|campaign| keep(&campaign.join("sections.csv"), |name| name != column));
        count += 1;
    }
    for key in required(&needs["vehicle"], |_| true) {
        let start = format!("{key}:");
        told(&key, &|campaign| {
            lines(&campaign.join("vehicle.yaml"), |lines| {
                lines.retain(|line| !line.starts_with(&start))
            })
        });
        count += 1;
    }
    assert!(count > 35, "{count} were removed");
}

/// Keys and headers are documented, so that other programs can read them.
#[test]
fn each_need_has_its_unit_and_users() {
    let needs = needs();
    let find = |list: &str, name: &str| {
        let found =
            needs[list].as_array().expect("a list").iter().find(|need| need["name"] == name);
        found.unwrap_or_else(|| panic!("no {name}")).clone()
    };
    let guiding = find("channels", "Y_1R");
    assert_eq!(
        (&guiding["unit"], &guiding["channel"], &guiding["record"]),
        (&"kN".into(), &"Y".into(), &"simulated".into())
    );
    assert_eq!(
        guiding["quantities"],
        serde_json::json!(["Y_qst", "YQ_qst", "SigmaY_qst", "Y_max", "YQ_max", "SigmaY_max"])
    );
    assert_eq!(
        (&find("channels", "curvature")["record"], &find("channels", "curvature")["required"]),
        (&"track".into(), &false.into())
    );
    assert_eq!(find("channels", "Y_2R")["required"], false, "only plausibility rules look at it");
    assert_eq!(find("sections", "cant")["unit"], "mm");
    assert_eq!(
        find("sections", "direction")["words"],
        serde_json::json!(["right", "left", "straight"])
    );
    let load = find("vehicle", "static_wheel_load");
    assert_eq!(
        (&load["unit"], &load["range"], &load["required"]),
        (&"kN".into(), &"10 kN to 200 kN".into(), &true.into())
    );
    assert_eq!(load["quantities"], serde_json::json!(["Q_qst", "Q_max"]));
    assert_eq!(
        (
            &find("vehicle", "admissible_speed")["default"],
            &find("vehicle", "admissible_speed")["required"]
        ),
        (&"not stated".into(), &true.into())
    );
    let ran = fishplate(&["explain", PROTOCOL, "--stage", "needs", "--format", "csv"]);
    assert!(
        ran.stdout.starts_with(
            "kind,record,name,channel,title,unit,words,range,default,required,needed by\n"
        ),
        "{}",
        ran.stdout
    );
    let listed = ["channels", "sections", "application", "vehicle"]
        .iter()
        .map(|list| needs[list].as_array().map_or(0, Vec::len))
        .sum::<usize>();
    assert_eq!(ran.stdout.lines().count(), listed + 1);
    assert_eq!(fishplate(&["explain", PROTOCOL, "--stage", "plan", "--format", "csv"]).code, 2);
    assert_eq!(fishplate(&["explain", PROTOCOL, "--stage", "needs", "--format", "svg"]).code, 2);
}

/// The table of wanted operation, and columns of every table of sections.
#[test]
fn wanted_operation_sites_and_states_are_listed() {
    let of = |protocol: &str| -> Value {
        let ran = fishplate(&["explain", protocol, "--stage", "needs", "--format", "json"]);
        serde_json::from_str(&ran.stdout).expect("JSON")
    };
    let names = |list: &Value| -> Vec<String> {
        list.as_array()
            .expect("a list")
            .iter()
            .map(|need| need["name"].as_str().expect("a name").to_string())
            .collect()
    };
    let application = of("en14363-2016-annex-t-application");
    let table = fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/coach-good/application.csv"),
    )
    .expect("a table");
    let mut given: Vec<&str> = table
        .lines()
        .next()
        .expect("a header")
        .split(',')
        .filter_map(|heading| heading.split(" [").next())
        .collect();
    let mut listed = names(&application["application"]);
    assert_eq!(listed[0], "point");
    given.retain(|name| listed.iter().any(|known| known == name));
    given.sort_unstable();
    listed.sort();
    assert_eq!(listed, given, "every column that the domain reads is in the example");
    assert!(names(&needs()["application"]).is_empty());
    let need = |needs: &Value, name: &str| {
        needs["sections"]
            .as_array()
            .expect("a list")
            .iter()
            .find(|need| need["name"] == name)
            .unwrap_or_else(|| panic!("no {name}"))
            .clone()
    };
    for name in ["site", "state", "repeat of", "track"] {
        assert_eq!(need(&application, name)["required"], false, "{name}");
    }
    let repeats = of("kraft");
    assert_eq!(need(&repeats, "repeat of")["required"], true);
    assert!(
        need(&repeats, "repeat of")["quantities"].as_array().is_some_and(|users| !users.is_empty())
    );
    assert!(
        of("stationary-sway")["sections"].as_array().is_some_and(Vec::is_empty),
        "whole records have no sections"
    );
    let text =
        fishplate(&["explain", "en14363-2016-annex-t-application", "--stage", "needs"]).stdout;
    assert!(text.contains("columns of the table of wanted operation\n  point"), "{text}");
}

/// What the protocol computes is in no table; what needs it needs the column that it follows from.
#[test]
fn what_is_computed_is_not_asked_for() {
    let protocol = "tests/cases/rule-sets/11-instability.fp";
    let ran = fishplate(&["explain", protocol, "--stage", "needs", "--format", "json"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let needs: Value = serde_json::from_str(&ran.stdout).expect("JSON");
    let sections = needs["sections"].as_array().expect("a list");
    let find = |name: &str| sections.iter().find(|need| need["name"] == name);
    assert!(find("class").is_none());
    let conicity = find("conicity").expect("a column");
    assert_eq!(conicity["required"], true);
    let users = ["measured_instability", "simulated_instability", "difference"];
    assert_eq!(conicity["quantities"], serde_json::json!(users));
}
