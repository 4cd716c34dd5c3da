//! Values that nobody confirmed, and requirements that could not be checked.

use std::fs;
use std::path::Path;

use crate::common::campaign::{copy, replace};
use crate::common::program::{Certified, certify};

const PROTOCOL: &str = "sprague-geers";

fn run(campaign: &Path, more: &[&str]) -> Certified {
    certify(campaign, &[&["--protocol", PROTOCOL, "--only", "html"], more].concat())
}

fn confirm(campaign: &Path, values: &[(&str, &str)], edition: &str) {
    let one = |(name, value): &(&str, &str)| {
        format!(
            "- name: {name}\n  value: {value}\n  clause: a test\n{edition}  by: test\n  date: 2026-01-01\n"
        )
    };
    let all: String = values.iter().map(one).collect();
    let yaml = campaign.join("campaign.yaml");
    let text = fs::read_to_string("examples/sprague-geers/campaign.yaml").expect("a campaign");
    fs::write(yaml, format!("{text}confirmed:\n{all}")).expect("written");
}

const VALUES: [(&str, &str); 3] =
    [("magnitude_limit", "25 %"), ("phase_limit", "0.25"), ("comprehensive_limit", "0.35")];

#[test]
fn a_verdict_is_provisional_until_its_values_are_confirmed() {
    let folder = copy(Path::new("examples/sprague-geers"));
    let found = run(folder.path(), &[]);
    let (code, results) = (found.ran.code, found.results());
    assert_eq!(results["provisional"].as_array().map(Vec::len), Some(3));
    assert_eq!(results["provisional"][0]["name"], "magnitude_limit");
    assert!(found.ran.stdout.contains(", provisional: 3 values not confirmed"));
    assert!(!found.text("report.html").contains("DRAFT"));
    // The words of the verdict in files and the exit code stay.
    assert!(["validated", "not validated"].contains(&results["verdict"].as_str().expect("a word")));
    assert_eq!(code, i32::from(results["verdict"] != "validated"));
    let last = run(folder.path(), &["--final"]);
    assert_eq!((last.ran.code, last.results()["draft"].as_bool()), (1, Some(true)));
    assert!(last.text("report.html").contains("DRAFT"));
    // Another value, and an edition that the protocol does not have.
    confirm(folder.path(), &[("magnitude_limit", "0.5")], "");
    let other = run(folder.path(), &[]);
    assert_eq!(other.results()["provisional"].as_array().map(Vec::len), Some(3));
    assert!(other.ran.stdout.contains("does not count: `0.25` is used"), "{}", other.ran.stdout);
    confirm(folder.path(), &VALUES[..1], "  edition: another\n");
    let other = run(folder.path(), &[]);
    assert_eq!(other.results()["provisional"].as_array().map(Vec::len), Some(3));
    assert!(other.ran.stdout.contains("does not count: it states an edition"));
    // All of them.
    confirm(folder.path(), &VALUES, "");
    let done = run(folder.path(), &["--final"]);
    let results = done.results();
    assert_eq!(results["provisional"].as_array().map(Vec::len), Some(0));
    assert_eq!(results["confirmed"][0]["by"], "test");
    assert_eq!(done.ran.code, code);
    assert!(
        !done.ran.stdout.contains("provisional") && !done.text("report.html").contains("DRAFT")
    );
    // A value that is set in place of a confirmed one is not confirmed.
    let set = run(folder.path(), &["--set", "phase_limit=0.3"]);
    assert_eq!(set.results()["provisional"][0]["value"], "0.3");
}

#[test]
fn a_requirement_that_could_not_be_checked_is_not_met() {
    let folder = copy(Path::new("examples/coach-good"));
    replace(&folder.path().join("vehicle.yaml"), "admissible_speed: 140 km/h", "");
    let found = certify(folder.path(), &["--only", "results"]);
    assert_eq!((found.ran.code, &found.results()["verdict"]), (1, &"not assessable".into()));
    let reasons = found.results()["reasons"].to_string();
    assert!(reasons.contains("minimum length") || reasons.contains("Minimum length"), "{reasons}");
    assert!(reasons.contains("`admissible_speed`"), "{reasons}");
    // The track is optional: what needs it is a deviation.
    let folder = copy(Path::new("examples/coach-good"));
    replace(&folder.path().join("campaign.yaml"), "track: track\n", "");
    let found = certify(folder.path(), &["--only", "results"]);
    assert_eq!(found.results()["verdict"], "validated");
    let deviations = found.results()["deviations"].to_string();
    assert!(deviations.contains("full curve"), "{deviations}");
}
