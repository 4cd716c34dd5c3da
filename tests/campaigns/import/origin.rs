//! Back to the raw files: records that were changed after their import, and imports that are repeated.

use std::fs;
use std::path::Path;

use tempfile::TempDir;

use crate::common::campaign::{copy, lines, replace};
use crate::common::program::{Ran, certify, fishplate};

/// The example with raw records, and the campaign that was imported from it.
struct Case {
    sources: TempDir,
    out: TempDir,
}

impl Case {
    fn new(more: &[&str]) -> Self {
        let sources = copy(Path::new("examples/foreign"));
        let out = tempfile::tempdir().expect("a folder");
        let case = Self { sources, out };
        let (mapping, to) = (case.sources.path().join("mapping.yaml"), case.campaign());
        let words = [mapping, to].map(|path| path.display().to_string());
        let all = [&["import", &words[0], "--out", &words[1], "-q"], more].concat();
        let ran = fishplate(&all);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        case
    }

    fn campaign(&self) -> std::path::PathBuf {
        self.out.path().join("campaign")
    }

    fn verify(&self, results: &Path, more: &[&str]) -> Ran {
        let words = [results, &self.campaign()].map(|path| path.display().to_string());
        fishplate(&[&["verify", &words[0], &words[1]], more].concat())
    }

    /// A record with one column times 0.8.
    fn scaled(&self, record: &str) {
        lines(&self.campaign().join(record), |lines| {
            for line in lines.iter_mut().skip(1) {
                let mut cells: Vec<String> = line.split(',').map(str::to_string).collect();
                let last = cells.last_mut().expect("a cell");
                *last = (last.parse::<f64>().expect("a number") * 0.8).to_string();
                *line = cells.join(",");
            }
        });
    }
}

/// The first measured record.
fn record(case: &Case) -> String {
    let origin = fs::read_to_string(case.campaign().join("origin.yaml")).expect("readable");
    let origin: serde_yaml::Value = serde_yaml::from_str(&origin).expect("YAML");
    let written = &origin["records"][0];
    assert!(written["sha256"].as_str().is_some_and(|hash| hash.len() == 64), "{written:?}");
    written["path"].as_str().expect("a path").into()
}

#[test]
fn a_record_that_was_changed_after_its_import_bars_the_verdict() {
    let case = Case::new(&[]);
    let name = record(&case);
    let sound = certify(&case.campaign(), &["--only", "results"]);
    let told = |results: &serde_json::Value| results["findings"].to_string();
    assert!(!told(&sound.results()).contains("record-changed"));
    case.scaled(&name);
    let changed = certify(&case.campaign(), &["--only", "results"]);
    let results = changed.results();
    assert_eq!(results["verdict_data"], "not assessable");
    let reasons = results["reasons"].to_string();
    assert!(reasons.contains("1 record is not as imported"), "{reasons}");
    assert!(told(&results).contains(&format!("`{name}` was changed after it was imported")));
    let folder = changed.folder();
    let ran = case.verify(&folder, &[]);
    assert!(ran.code == 1 && ran.stdout.contains(&format!("changed: {name}")), "{}", ran.stdout);
    // The campaign says so.
    let yaml = case.campaign().join("campaign.yaml");
    let text = fs::read_to_string(&yaml).expect("readable");
    let edited = format!("{text}edited:\n- record: {name}\n  reason: amplifier set to 0.8\n");
    fs::write(&yaml, &edited).expect("written");
    let edited_one = certify(&case.campaign(), &["--only", "html"]);
    let results = edited_one.results();
    assert_eq!(results["reasons"], sound.results()["reasons"]);
    assert!(told(&results).contains("amplifier set to 0.8"));
    let html = edited_one.text("report.html");
    let printed = html.split_once(" was edited after its import: ").expect("a deviation").1;
    assert!(printed.starts_with("amplifier set to 0.8."), "{}", &printed[..200]);
    let ran = case.verify(&edited_one.folder(), &[]);
    assert_eq!(ran.code, 0, "{}", ran.stdout);
    assert!(ran.stdout.contains("1 of them edited, as campaign.yaml says"), "{}", ran.stdout);
    let sources = case.sources.path().display().to_string();
    let ran = case.verify(&edited_one.folder(), &["--sources", &sources]);
    assert_eq!(ran.code, 0, "{}", ran.stdout);
    // A record that no import wrote.
    fs::write(&yaml, edited.replace(&name, "measurement/none.csv")).expect("written");
    let words = [case.campaign(), case.out.path().join("r")].map(|path| path.display().to_string());
    let ran = fishplate(&["certify", &words[0], "--out", &words[1]]);
    assert!(ran.code == 2 && ran.stderr.contains("unknown-record"), "{}", ran.stderr);
    // Records from another folder are not those that were imported.
    fs::write(&yaml, text.replace("measurement: measurement", "measurement: other"))
        .expect("written");
    fs::rename(case.campaign().join("measurement"), case.campaign().join("other")).expect("moved");
    let elsewhere = certify(&case.campaign(), &["--only", "results"]).results();
    assert!(elsewhere["reasons"].to_string().contains("2 records are not as imported"));
    assert!(told(&elsewhere).contains("was not written by the import"), "{}", told(&elsewhere));
}

/// The origin goes along with the format of the records.
#[test]
fn converted_records_are_still_those_that_were_imported() {
    let case = Case::new(&[]);
    let to = case.out.path().join("parquet");
    let words = [case.campaign(), to.clone()].map(|path| path.display().to_string());
    let ran = fishplate(&["convert-records", &words[0], "--to", "parquet", "--out", &words[1]]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let findings = certify(&to, &["--only", "results"]).results()["findings"].to_string();
    assert!(!findings.contains("record-changed"), "{findings}");
}

#[test]
fn an_import_is_repeated_and_compared() {
    for format in ["csv", "parquet"] {
        let case = Case::new(&["--records", format]);
        let report = certify(&case.campaign(), &["--only", "results"]);
        let folder = report.folder();
        let sources = case.sources.path().display().to_string();
        let ran = case.verify(&folder, &["--sources", &sources]);
        assert_eq!(ran.code, 0, "{}{}", ran.stdout, ran.stderr);
        assert!(ran.stdout.contains("sources         imported again"), "{}", ran.stdout);
        // A raw file that is another one now.
        let raw = case.sources.path().join("messung/Messung_S06.csv");
        let before = fs::read(&raw).expect("readable");
        let mut after = before.clone();
        // The last number of a row in the middle.
        let middle = after.len() / 2;
        let row = middle + after[middle..].iter().position(|byte| *byte == b'\n').expect("a row");
        let digit = after[..row].iter().rposition(u8::is_ascii_digit).expect("a digit");
        after[digit] = if after[digit] == b'1' { b'2' } else { b'1' };
        fs::write(&raw, after).expect("written");
        let ran = case.verify(&folder, &["--sources", &sources]);
        assert_eq!(ran.code, 1, "{}", ran.stdout);
        for says in [
            "source messung/Messung_S06.csv: SHA-256 ",
            &format!("measurement/S06.{format}: not what the import makes of its sources"),
        ] {
            assert!(ran.stdout.contains(says), "{says}\n{}", ran.stdout);
        }
        fs::write(&raw, before).expect("written");
        // The list of hashes in the origin was changed along with a record.
        if format == "csv" {
            case.scaled("measurement/S06.csv");
            let ran = case.verify(&folder, &["--sources", &sources]);
            assert!(ran.stdout.contains("measurement/S06.csv: not what"), "{}", ran.stdout);
        }
        fs::remove_file(&raw).expect("removed");
        let ran = case.verify(&folder, &["--sources", &sources]);
        assert!(ran.code == 1 && ran.stdout.contains("cannot be repeated"), "{}", ran.stdout);
        replace(&case.campaign().join("campaign.yaml"), "origin: origin.yaml", "");
        let ran = case.verify(&folder, &["--sources", &sources]);
        assert!(ran.stdout.contains("was not written by an import"), "{}", ran.stdout);
    }
}
