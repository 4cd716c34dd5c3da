//! Files of results: read into their types and written again they have the same bytes, and their
//! schemas describe them.

use std::fs;
use std::path::{Path, PathBuf};

use fishplate::cli::schema::{Of, schema};
use fishplate::result::comparison::Comparison;
use fishplate::result::diagnosis::Diagnosis;
use fishplate::result::impact::Impact;
use fishplate::result::study::Study;
use fishplate::result::{Certification, text};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::common::program;

const EXAMPLES: [(&str, &[&str]); 16] = [
    ("coach", &[]),
    ("coach-good", &[]),
    ("run", &[]),
    ("two-link-arm", &[]),
    ("repeats", &["--protocol", "kraft"]),
    ("code-benchmark", &[]),
    ("sprague-geers", &["--protocol", "sprague-geers"]),
    ("sway", &["--protocol", "stationary-sway"]),
    ("double-pendulum", &["--protocol", "examples/double-pendulum/double-pendulum.fp"]),
    ("coach-good", &["--protocol", "en14363-on-track-assessment"]),
    ("coach-good", &["--protocol", "en14363-on-track-assessment-two-dimensional"]),
    ("coach-good", &["--protocol", "en14363-virtual-against-measured"]),
    ("coach-good", &["--protocol", "en14363-2016-annex-t-application"]),
    ("coach", &["--protocol", "metrics-side-by-side"]),
    ("code-benchmark", &["--protocol", "code-benchmark-reference"]),
    ("coach", &["examples/coach-good"]),
];

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Runs a command with an output folder, and checks the file that it writes.
fn check<T: Serialize + DeserializeOwned>(arguments: &[&str], file: &str, of: Of) {
    let out = tempfile::tempdir().expect("a temporary folder");
    let command = &mut program::program();
    let ran = program::ran(
        command.current_dir(root()).args(arguments).args(["--quiet", "--out"]).arg(out.path()),
    );
    assert!(ran.code < 2, "{arguments:?}: {}", ran.stderr);
    check_file::<T>(&out.path().join(file), of);
}

fn check_file<T: Serialize + DeserializeOwned>(path: &Path, of: Of) {
    let written = fs::read_to_string(path).expect("the file of the result");
    let read: T = serde_json::from_str(&written)
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let again = text(&read);
    let differs = written.lines().zip(again.lines()).find(|(a, b)| a != b);
    assert!(again == written, "{}: {differs:?}", path.display());
    let value: Value = serde_json::from_str(&written).expect("JSON");
    assert_eq!(value["format"], 1);
    let validator = jsonschema::validator_for(&schema(of)).expect("a schema");
    let errors: Vec<String> = validator
        .iter_errors(&value)
        .take(3)
        .map(|error| format!("{} at {}", error, error.instance_path))
        .collect();
    assert!(errors.is_empty(), "{}: {errors:#?}", path.display());
    // A schema that allows everything would describe nothing.
    assert!(!validator.is_valid(&serde_json::json!({"format": 1})));
}

#[test]
fn certifications_are_read_as_they_are_written() {
    for (campaign, more) in EXAMPLES {
        let campaign = format!("examples/{campaign}");
        let arguments = [&["certify", campaign.as_str(), "--only", "results"], more].concat();
        check::<Certification>(&arguments, "results.json", Of::Results);
    }
}

#[test]
fn studies_are_read_as_they_are_written() {
    for more in [
        &["sections"][..],
        &["sections", "--enumerate", "1000", "--width", "0.2"],
        &["sync"],
        &["sync", "--take", "2"],
        &["parameters", "--vary", "lowpass_frequency=15..25 step 5 Hz"],
    ] {
        let arguments = [&["study", more[0], "examples/coach"], &more[1..]].concat();
        check::<Study>(&arguments, "study.json", Of::Study);
    }
}

#[test]
fn comparisons_are_read_as_they_are_written() {
    let arguments = [
        "compare",
        "examples/coach-good",
        "--protocol",
        "en14363-2016-annex-t",
        "--protocol",
        "en14363-2016-annex-t-strict-acceleration",
        "--no-report",
    ];
    check::<Comparison>(&arguments, "comparison.json", Of::Comparison);
}

#[test]
fn impacts_are_read_as_they_are_written() {
    let arguments = [
        "impact",
        "en14363-2016-annex-t",
        "en14363-2016-annex-t-strict-acceleration",
        "--over",
        "examples/coach-good",
        "--no-report",
    ];
    check::<Impact>(&arguments, "impact.json", Of::Impact);
}

#[test]
fn diagnoses_are_read_as_they_are_written() {
    let arguments = [
        "diagnose",
        "examples/two-link-arm",
        "--protocol",
        "examples/two-link-arm/protocol.fp",
        "--effects",
        "examples/two-link-arm/effects.yaml",
        "--simulator",
        "examples/two-link-arm/sim.yaml",
    ];
    check::<Diagnosis>(&arguments, "diagnosis.json", Of::Diagnosis);
}
