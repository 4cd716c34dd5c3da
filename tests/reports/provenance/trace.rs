//! `trace`: any number of a report leads to the line of its rule and the rows of its data.

use std::fs;
use std::path::Path;

use serde_json::Value;

use fishplate::problem::Problems;
use fishplate::provenance::carried;
use fishplate::provenance::trace::{Asked, trace};

use super::campaign::{cell, copy};
use super::program::{Ran, fishplate};
use super::{example, root, text, written};

fn traced(report: &Path, of: [&str; 3], more: &[&str]) -> Ran {
    let report = text(report);
    let mut arguments = vec!["trace", report.as_str()];
    arguments.extend(of);
    arguments.extend(more);
    fishplate(&arguments)
}

const OF: [&str; 3] = ["Y_max", "S05", "Y_1R"];

/// The rows it names are those of the section, counted here from the file itself.
#[test]
fn rows_columns_and_rules_are_where_it_says() {
    let written = written();
    let campaign = text(&written.campaign());
    let ran = traced(&written.results(), OF, &["--campaign", &campaign]);
    assert_eq!(ran.code, 0, "{}{}", ran.stdout, ran.stderr);
    let results: Value =
        serde_json::from_str(&fs::read_to_string(written.results()).expect("readable"))
            .expect("JSON");
    let section = results["sections"]
        .as_array()
        .expect("a list")
        .iter()
        .find(|section| section["section"] == "S05")
        .expect("S05");
    let (start, end) =
        (section["start"].as_f64().expect("a number"), section["end"].as_f64().expect("a number"));
    for kind in ["simulation", "measurement"] {
        let path = written.campaign().join(kind).join("S05.csv");
        let record = fs::read_to_string(&path).expect("readable");
        let header: Vec<&str> = record.lines().next().expect("a header").split(',').collect();
        let distance = header.iter().position(|name| *name == "distance [m]").expect("a distance");
        let inside: Vec<usize> = record
            .lines()
            .enumerate()
            .skip(1)
            .filter(|(_, row)| {
                let at: f64 = row
                    .split(',')
                    .nth(distance)
                    .and_then(|cell| cell.parse().ok())
                    .expect("a number");
                start <= at && at <= end
            })
            .map(|(at, _)| at + 1)
            .collect();
        let (first, last, all) = (inside[0], inside[inside.len() - 1], record.lines().count());
        let says =
            format!("rows       {first} to {last} lie in the section, 2 to {all} are filtered");
        assert!(ran.stdout.contains(&says), "{says}\n{}", ran.stdout);
        let hash = results["campaign"]["files"]
            .as_array()
            .expect("a list")
            .iter()
            .find(|file| file["record"]["section"] == "S05" && file["record"]["kind"] == kind)
            .and_then(|file| file["sha256"].as_str())
            .expect("a hash");
        assert!(ran.stdout.contains(hash));
    }
    for says in [
        "columns read: distance, time, Y_1R",
        "low-pass 19.5 Hz",
        "p99.85",
        "as in the report",
        "verdict of the report: not validated",
    ] {
        assert!(ran.stdout.contains(says), "{says}\n{}", ran.stdout);
    }
    // The quantity is changed by the variant's parent, so its rule stands there, and the limit too.
    assert!(
        ran.stdout.contains("rule  (p.fp:4)") && ran.stdout.contains("(p.fp:5)"),
        "{}",
        ran.stdout
    );
    // Lines named are those of the rules.
    let shipped =
        fs::read_to_string(root().join("protocols/en14363-2016-annex-t.fp")).expect("readable");
    let entry = results["quantities"]
        .as_array()
        .expect("a list")
        .iter()
        .find(|quantity| quantity["id"] == "ay_max")
        .expect("ay_max");
    let line = |place: &Value| {
        assert_eq!(place["file"], "en14363-2016-annex-t.fp");
        let line =
            place["line"].as_u64().and_then(|line| usize::try_from(line).ok()).expect("a line");
        shipped.lines().nth(line - 1).expect("a line").to_string()
    };
    assert!(line(&entry["rule"]).starts_with("quantity ay_max "), "{}", line(&entry["rule"]));
    for statistic in entry["statistics"].as_array().expect("a list") {
        let name = statistic["name"].as_str().expect("a name");
        assert!(
            line(&statistic["rule"]).trim_start().starts_with("limit")
                && line(&statistic["rule"]).contains(name)
        );
    }
}

/// Not a sample of them: every value of every quantity in the results.
#[test]
fn every_value_can_be_traced() {
    let mut count = 0;
    let run = |out: &Path, campaign: &Path, every: usize, count: &mut usize| {
        let carried =
            carried::open(out).unwrap_or_else(|problem| panic!("{}", problem.render(false)));
        let mut problems = Problems::default();
        let sources = carried.sources(None).expect("the protocol is there");
        let compiled = carried.compiled(&sources, &mut problems).expect("the protocol compiles");
        for quantity in &carried.results.quantities {
            for (at, pair) in quantity.values.iter().enumerate() {
                let asked = Asked {
                    quantity: &quantity.id,
                    section: &pair.section,
                    signal: &pair.signal,
                    record: None,
                };
                let campaigns: Vec<_> =
                    (at % every == 0).then(|| campaign.to_path_buf()).into_iter().collect();
                let found = trace(&carried, Some(&compiled), asked, &campaigns);
                let found = found.unwrap_or_else(|problems| panic!("{}", problems.render(false)));
                let told = found.text.text();
                assert!(found.agrees, "{told}");
                assert!(told.contains("SHA-256") && told.contains("columns read: "), "{told}");
                *count += 1;
            }
        }
    };
    run(&written().pdf(), &written().campaign(), 7, &mut count);
    for (campaign, protocol) in [("sprague-geers", "sprague-geers"), ("sway", "stationary-sway")] {
        let out = tempfile::tempdir().expect("a folder");
        let (folder, to) = (text(&example(campaign)), text(out.path()));
        let ran = fishplate(&[
            "certify",
            &folder,
            "--protocol",
            protocol,
            "--out",
            &to,
            "--only",
            "results",
            "-q",
        ]);
        assert!(ran.code <= 1, "{}", ran.stderr);
        run(out.path(), &example(campaign), 1, &mut count);
    }
    assert!(count > 470, "{count}");
}

#[test]
fn a_campaign_that_changed_is_told() {
    let campaign = copy(&written().campaign());
    cell(&campaign.path().join("measurement/S05.csv"), 400, "Y_1R [kN]", "60.00");
    let ran = traced(&written().results(), OF, &["--campaign", &text(campaign.path())]);
    assert_eq!(ran.code, 1, "{}", ran.stdout);
    assert!(
        ran.stdout.contains("CHANGED") && ran.stdout.contains("NOT as in the report"),
        "{}",
        ran.stdout
    );
    let other = traced(
        &written().results(),
        ["Y_max", "S06", "Y_1R"],
        &["--campaign", &text(campaign.path())],
    );
    assert_eq!(other.code, 0, "{}", other.stdout);
}

#[test]
fn names_that_are_not_there_are_suggested() {
    for (of, says) in [
        (["Y_mx", "S05", "Y_1R"], "did you mean `Y_max`?"),
        (["Y_max", "S055", "Y_1R"], "did you mean `S05`?"),
        (["Y_max", "S05", "Y_9R"], "Y_1R"),
    ] {
        let ran = traced(&written().results(), of, &[]);
        assert!(ran.code == 2 && ran.stderr.contains(says), "{of:?}: {}", ran.stderr);
    }
    // A section that is not used has no value, and says why.
    let campaign = copy(&written().campaign());
    fs::remove_file(campaign.path().join("simulation/S01.csv")).expect("removed");
    let out = tempfile::tempdir().expect("a folder");
    let ran = fishplate(&[
        "certify",
        &text(campaign.path()),
        "--out",
        &text(out.path()),
        "--only",
        "results",
        "-q",
    ]);
    assert!(ran.code <= 1, "{}", ran.stderr);
    let ran = traced(out.path(), ["Y_max", "S01", "Y_1R"], &[]);
    assert!(ran.code == 2 && ran.stderr.contains("S01 is not used"), "{}", ran.stderr);
}

/// Without a protocol, what stands in the results is still shown.
#[test]
fn results_alone_still_lead_to_files_and_lines() {
    let bare = tempfile::tempdir().expect("a folder");
    fs::copy(written().results(), bare.path().join("results.json")).expect("copied");
    let ran = traced(&bare.path().join("results.json"), OF, &[]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(
        ran.stdout.contains("measurement/S05.csv") && ran.stdout.contains("--protocol"),
        "{}",
        ran.stdout
    );
    let asked = traced(
        &bare.path().join("results.json"),
        OF,
        &["--campaign", &text(&written().campaign())],
    );
    assert!(asked.code == 2 && asked.stderr.contains("protocol-missing"), "{}", asked.stderr);
}

/// A run is the record of each of its sections. Of a section, the part around it is filtered.
#[test]
fn a_run_stands_once() {
    let out = tempfile::tempdir().expect("a temporary folder");
    let folder = text(out.path());
    let ran = fishplate(&["certify", "examples/run", "--only", "results", "--out", &folder]);
    assert!(ran.code < 2, "{}", ran.stderr);
    let ran = traced(
        &out.path().join("results.json"),
        ["Y_max", "S02", "Y_1R"],
        &["--campaign", "examples/run"],
    );
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert_eq!(ran.stdout.matches("SHA-256").count(), 2, "{}", ran.stdout);
    let filtered = ran
        .stdout
        .lines()
        .find_map(|line| line.split_once("lie in the section, "))
        .expect("told")
        .1;
    assert!(filtered.ends_with("are filtered") && !filtered.starts_with("2 to"), "{filtered}");
}
