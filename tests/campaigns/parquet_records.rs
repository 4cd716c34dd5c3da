//! Records as Parquet files, as a user has them: the same report as from text, and the same
//! refusals.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::common::campaign::copy;
use crate::common::program::{certify, files, fishplate};
use fishplate::data::hash::sha256;
use fishplate::data::record::{Wanted, read_record};
use fishplate::data::write::{FileColumn, Values, parquet};
use fishplate::units::Dimension;
use serde_json::Value;
use tempfile::TempDir;

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name)
}

/// The campaign with its records in another format.
#[track_caller]
fn converted(campaign: &Path, to: &str) -> (TempDir, String) {
    let out = tempfile::tempdir().expect("a temporary folder");
    let words = [campaign.as_os_str(), out.path().as_os_str()]
        .map(|word| word.to_string_lossy().into_owned());
    let ran = fishplate(&["convert-records", &words[0], "--to", to, "--out", &words[1]]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    (out, ran.stderr)
}

/// What does not depend on the bytes of the records.
fn numbers(results: &Value) -> [Value; 3] {
    ["quantities", "verdict", "sections"].map(|key| results.get(key).cloned().unwrap_or_default())
}

#[test]
fn there_and_back_is_the_same_text_and_the_same_report() {
    let campaign = example("coach-good");
    let (there, said) = converted(&campaign, "parquet");
    assert!(said.contains("records converted"), "{said}");
    assert!(!there.path().join("measurement/S01.csv").exists());
    let (back, _) = converted(there.path(), "csv");
    let mut compared = 0;
    for side in ["measurement", "simulation", "track"] {
        for path in files(&campaign.join(side)) {
            let name = path.file_name().expect("a name");
            let again = fs::read(back.path().join(side).join(name)).expect("converted back");
            assert!(again == fs::read(&path).expect("an example"), "{}", path.display());
            compared += 1;
        }
    }
    assert!(compared >= 20, "{compared} records");
    let (from_text, from_columns) =
        (certify(&campaign, &["--only", "results"]), certify(there.path(), &["--only", "results"]));
    assert_eq!(numbers(&from_text.results()), numbers(&from_columns.results()));
    assert_eq!(from_text.ran.code, from_columns.ran.code);
    // A second conversion gives the same bytes.
    let (again, _) = converted(back.path(), "parquet");
    let of = |folder: &TempDir| {
        fs::read(folder.path().join("simulation/S01.parquet")).expect("converted")
    };
    assert!(of(&there) == of(&again));
}

#[test]
fn a_report_from_parquet_is_verified_and_traced() {
    let (campaign, _) = converted(&example("coach-good"), "parquet");
    let report = certify(campaign.path(), &["--only", "results"]);
    let results = report.folder().join("results.json").display().to_string();
    let folder = campaign.path().display().to_string();
    let verified = fishplate(&["verify", &results, &folder]);
    assert_eq!(verified.code, 0, "{}{}", verified.stdout, verified.stderr);
    let traced = fishplate(&["trace", &results, "Y_max", "S01", "Y_1R", "--campaign", &folder]);
    assert_eq!(traced.code, 0, "{}{}", traced.stdout, traced.stderr);
    assert!(
        traced.stdout.contains("measurement/S01.parquet")
            && traced.stdout.contains("as in the report"),
        "{}",
        traced.stdout
    );
    let path = campaign.path().join("measurement/S01.parquet");
    let mut bytes = fs::read(&path).expect("a record");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&path, bytes).expect("changed");
    assert_eq!(fishplate(&["verify", &results, &folder]).code, 1);
}

#[test]
fn a_simulation_is_the_same_in_both_formats() {
    let out = tempfile::tempdir().expect("a temporary folder");
    let campaign = example("coach-good").display().to_string();
    let made = ["csv", "parquet"].map(|format| {
        let folder = out.path().join(format);
        let words = [
            "simulate",
            &campaign,
            "--effect",
            "friction=0.5",
            "--records",
            format,
            "--out",
            &folder.display().to_string(),
        ];
        let ran = fishplate(&words);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        assert!(folder.join(format!("simulation/S01.{format}")).exists());
        certify(&folder, &["--only", "results"]).results()
    });
    assert_eq!(numbers(&made[0]), numbers(&made[1]));
}

#[test]
fn two_formats_of_one_record_are_refused_by_both_names() {
    let campaign = copy(&example("coach-good"));
    let (parquet, _) = converted(campaign.path(), "parquet");
    fs::copy(
        parquet.path().join("measurement/S01.parquet"),
        campaign.path().join("measurement/S01.parquet"),
    )
    .expect("copied");
    let report = certify(campaign.path(), &["--only", "results"]);
    let reason = report.reason("S01").expect("not used");
    assert!(reason.contains("`measurement/S01.csv` and `measurement/S01.parquet`"), "{reason}");
}

/// The simulation was fitted to these measurements, whatever their format.
#[test]
fn a_conversion_does_not_hide_what_a_simulation_was_fitted_to() {
    let campaign = copy(&example("coach-good"));
    let hash = sha256(&fs::read(campaign.path().join("measurement/S01.csv")).expect("a record"));
    let file = format!("- path: measurement/S01.csv\n  sha256: {hash}\n");
    let origin = format!(
        "program: fishplate 0.1.0\ncommand: diagnose\ncampaign: c\neffects:\n- effect: friction\n  parameters:\n  - name: friction\n    value: 0.3\n    unit: \"-\"\nfitted to:\n{file}sources:\n{file}"
    );
    fs::write(campaign.path().join("origin.yaml"), origin).expect("written");
    let yaml = campaign.path().join("campaign.yaml");
    let text = fs::read_to_string(&yaml).expect("a campaign");
    fs::write(&yaml, text + "origin: origin.yaml\n").expect("written");
    let (there, _) = converted(campaign.path(), "parquet");
    for folder in [campaign.path(), there.path()] {
        let note = certify(folder, &["--only", "results"]).results()["verdict_note"].clone();
        assert_eq!(
            note,
            "with a simulation fitted to the same measurements",
            "{}",
            folder.display()
        );
    }
}

/// A page of zeros that inflates to 160 MB from some kilobytes, one that was cut off, and a text
/// under this name.
#[test]
fn bad_records_leave_their_section_out() {
    let (campaign, _) = converted(&example("coach-good"), "parquet");
    let place = |name: &str| campaign.path().join("measurement").join(name);
    let whole = fs::read(place("S02.parquet")).expect("a record");
    fs::write(place("S02.parquet"), &whole[..whole.len() - 100]).expect("cut off");
    fs::copy(example("coach-good").join("measurement/S03.csv"), place("S03.parquet"))
        .expect("copied");
    fs::write(place("S05.parquet"), b"").expect("emptied");
    let numbers = |heading: &str, values: Vec<f64>| FileColumn {
        heading: heading.into(),
        values: Values::Numbers(values),
        digits: None,
    };
    let zeros = vec![0.0; 20_000_000];
    fs::write(place("S06.parquet"), parquet(&[numbers("time [s]", zeros)]).expect("written"))
        .expect("written");
    let start = Instant::now();
    let report = certify(campaign.path(), &["--only", "results"]);
    // A minute is far more than it takes on any machine, and far less than the search of gigabytes.
    assert!(start.elapsed() < Duration::from_secs(60));
    for (section, words) in [
        ("S02", "its end is missing"),
        ("S03", "is not a Parquet file"),
        ("S05", "is empty"),
        ("S06", "measurement/S06.parquet"),
    ] {
        let reason = report.reason(section).expect("not used");
        assert!(reason.contains(words), "{section}: {reason}");
    }
}

#[test]
fn a_protocol_of_the_campaign_goes_along() {
    let campaign = copy(&example("coach-good"));
    let file = campaign.path().join("campaign.yaml");
    let text = fs::read_to_string(&file).expect("a campaign");
    let kept: String = text
        .lines()
        .filter(|line| !line.starts_with("protocol:"))
        .map(|line| format!("{line}\n"))
        .collect();
    fs::write(&file, format!("protocol: own.fp\n{kept}")).expect("written");
    let write = |name: &str, extends: &str| {
        let path = campaign.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        fs::write(path, format!("protocol own \"Own\"\n  extends {extends}\n")).expect("written");
    };
    write("own.fp", "rules/house.fp");
    write("rules/house.fp", "base.fp");
    write("rules/base.fp", "en14363-2016-annex-t");
    let (there, _) = converted(campaign.path(), "parquet");
    for name in ["own.fp", "rules/house.fp", "rules/base.fp"] {
        assert!(there.path().join(name).is_file(), "{name}");
    }
    assert!(!certify(there.path(), &["--only", "results"]).results()["quantities"].is_null());
}

#[test]
fn a_record_that_cannot_be_converted_leaves_nothing() {
    let campaign = copy(&example("coach-good"));
    let path = campaign.path().join("simulation/S02.csv");
    let text = fs::read_to_string(&path).expect("a record");
    fs::write(&path, text[..text.len() / 2].trim_end_matches(|c: char| c != ',')).expect("cut off");
    let out = campaign.path().join("out");
    let words = [campaign.path(), &out].map(|path| path.display().to_string());
    let ran = fishplate(&["convert-records", &words[0], "--to", "parquet", "--out", &words[1]]);
    assert_eq!(ran.code, 2, "{}", ran.stderr);
    assert!(ran.stderr.contains("simulation/S02.csv") && !out.exists(), "{}", ran.stderr);
}

/// Written by Arrow C++ with a checksum for each page, uncompressed: a changed byte of a value
/// would else be another number.
#[test]
fn checksums_of_pages_are_looked_at() {
    let whole = include_bytes!("../cases/data/checksums.parquet");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let wanted =
        [Wanted::new("distance", Dimension::LENGTH), Wanted::new("ay", Dimension::ACCELERATION)];
    let read = |bytes: &[u8]| {
        let path = folder.path().join("r.parquet");
        fs::write(&path, bytes).expect("written");
        read_record(&path, "r.parquet", &wanted)
    };
    let record = read(whole).expect("sound");
    let distances: Vec<f64> = (0..40).map(|row| 0.5 * f64::from(row)).collect();
    assert_eq!(record.columns[0].values, distances);
    let value = 2.5_f64.to_le_bytes();
    let at = whole.windows(8).position(|bytes| bytes == value).expect("the sixth distance");
    let mut changed = whole.to_vec();
    changed[at + 6] ^= 1;
    let problems = read(&changed).expect_err("another number");
    let Some(problem) = problems.first() else { panic!("no problem") };
    assert!(problem.code == "file-damaged" && problem.says.contains("CRC"), "{}", problem.says);
}
