//! The shipped example: a draft of its files, and the campaign that its mapping makes.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

fn run(words: &[&str]) -> (i32, String, String) {
    let done = Command::new(env!("CARGO_BIN_EXE_fishplate")).args(words).output().expect("started");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (done.status.code().unwrap_or(-1), text(&done.stdout), text(&done.stderr))
}

/// Columns of a record by name, as texts.
fn columns(path: &Path) -> Vec<(String, Vec<f64>)> {
    let text = fs::read_to_string(path).expect("a record");
    let mut lines = text.lines();
    let names: Vec<String> =
        lines.next().expect("a header").split(',').map(str::to_string).collect();
    let rows: Vec<Vec<f64>> = lines
        .map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect())
        .collect();
    names
        .into_iter()
        .enumerate()
        .map(|(at, name)| (name, rows.iter().map(|row| row[at]).collect()))
        .collect()
}

#[test]
fn the_example_is_imported_and_certified() {
    let out = tempfile::tempdir().expect("a folder");
    let campaign = out.path().join("campaign");
    let shown = campaign.display().to_string();
    let (exit, _, said) = run(&["import", "examples/foreign/mapping.yaml", "--out", &shown]);
    assert_eq!(exit, 0, "{said}");
    assert!(said.contains("written: 4 records of 2 sections"), "{said}");
    // The measurement in the file and in the campaign: the left guiding forces have the other sign.
    let found = columns(&campaign.join("measurement/S13.csv"));
    let text = fs::read("examples/foreign/messung/Messung_S13.csv").expect("the source");
    let text: String = text.iter().map(|byte| char::from(*byte)).collect();
    let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(';').collect()).collect();
    let source = |name: &str| -> Vec<f64> {
        let at = lines[0].iter().position(|known| *known == name).expect("a channel");
        lines[2..].iter().map(|row| row[at].replace(',', ".").parse().expect("a number")).collect()
    };
    for (name, from, sign) in [
        ("distance [m]", "Weg", 1.0),
        ("Y_1R [kN]", "ST1 Y re", 1.0),
        ("Y_1L [kN]", "ST1 Y li", -1.0),
        ("az_II [m/s^2]", "WK2 z..", 1.0),
    ] {
        let (_, values) = found.iter().find(|(known, _)| known == name).expect("a column");
        let wanted: Vec<f64> = source(from).iter().map(|value| sign * value + 0.0).collect();
        assert_eq!(*values, wanted, "{name}");
    }
    let report = out.path().join("report");
    let (exit, printed, said) =
        run(&["certify", &shown, "--out", &report.display().to_string(), "--only", "html"]);
    assert_eq!(exit, 1, "{printed}{said}");
    let html = fs::read_to_string(report.join("report.html")).expect("a report");
    assert!(
        html.contains("How the records were made") && html.contains("Y_1L = -ST1 Y li"),
        "no account in the report"
    );
    let results: Value =
        serde_json::from_str(&fs::read_to_string(report.join("results.json")).expect("results"))
            .expect("JSON");
    let made = &results["campaign"]["origin"]["imported"];
    assert_eq!(made[0]["side"], "measurement");
    assert_eq!(made[1]["records"][1]["file"], "simulation/S13.parquet");
}

#[test]
fn a_draft_is_a_mapping_with_open_places() {
    let out = tempfile::tempdir().expect("a folder");
    let path = out.path().join("draft.yaml").display().to_string();
    let files = [
        "messung/Messung_S06.csv",
        "messung/Messung_S13.csv",
        "simulation/S06.parquet",
        "simulation/S13.parquet",
    ];
    let files: Vec<String> = files.iter().map(|name| format!("examples/foreign/{name}")).collect();
    let mut words = vec!["import", "--draft", "--out", &path];
    words.extend(files.iter().map(String::as_str));
    let (exit, _, said) = run(&words);
    assert_eq!(exit, 0, "{said}");
    let draft = fs::read_to_string(&path).expect("a draft");
    for part in [
        "examples/foreign/messung/Messung_{section}.csv",
        "examples/foreign/simulation/{section}.parquet",
        "distance: Weg",
        "Q_1R: ST1 Q re",
        "common to 8 channels",
        "Y_1L: \"?\"",
        "Y_2L: \"?\"",
        "Y_1R: Y11",
    ] {
        assert!(draft.contains(part), "no `{part}` in\n{draft}");
    }
    // Nothing is applied before the open places are decided.
    let campaign = out.path().join("campaign");
    let (exit, _, said) = run(&["import", &path, "--out", &campaign.display().to_string()]);
    assert!(exit == 2 && said.contains("open-place") && !campaign.exists(), "{said}");
}

/// Text files without units: the axes are known by name, and every unit is an open place.
#[test]
fn a_draft_of_files_without_units() {
    let out = tempfile::tempdir().expect("a folder");
    let mut files = Vec::new();
    for section in ["S06", "S13"] {
        let bytes = fs::read(format!("examples/foreign/messung/Messung_{section}.csv"))
            .expect("the source");
        let text: String = bytes.iter().map(|byte| char::from(*byte)).collect();
        let lines: Vec<&str> =
            text.lines().enumerate().filter(|(at, _)| *at != 1).map(|(_, line)| line).collect();
        let path = out.path().join(format!("Messung_{section}.csv"));
        fs::write(&path, lines.join("\n")).expect("written");
        files.push(path.display().to_string());
    }
    let path = out.path().join("draft.yaml").display().to_string();
    let (exit, _, said) = run(&["import", "--draft", &files[0], &files[1], "--out", &path]);
    assert_eq!(exit, 0, "{said}");
    let draft = fs::read_to_string(&path).expect("a draft");
    for part in [
        "time: {from: Zeit, unit: \"?\"}",
        "distance: {from: Weg, unit: \"?\"}",
        "Q_1R: {from: ST1 Q re, unit: \"?\"}",
        "the file states no unit: kN in the protocol",
        "Y_1L: \"?\"",
        "with its unit: {from: ST1 Y li, unit: ...}",
    ] {
        assert!(draft.contains(part), "no `{part}` in\n{draft}");
    }
    let (exit, _, said) =
        run(&["import", &path, "--out", &out.path().join("campaign").display().to_string()]);
    assert!(exit == 2 && said.contains("open-place") && !said.contains("unit-missing"), "{said}");
}

/// After the import, a finding has the consequence that it has in the report.
#[test]
fn findings_have_the_consequence_of_the_evaluation() {
    let out = tempfile::tempdir().expect("a folder");
    let folder = fs::canonicalize("examples/foreign").expect("the example");
    let mut text = fs::read_to_string("examples/foreign/mapping.yaml")
        .expect("the example")
        .replace("Q_1R: ST1 Q re", "Q_1R: -ST1 Q re");
    for name in ["sections.csv", "vehicle.yaml", "messung/", "simulation/"] {
        text = text.replace(&format!(": {name}"), &format!(": {}/{name}", folder.display()));
    }
    let path = out.path().join("mapping.yaml");
    fs::write(&path, text).expect("written");
    let campaign = out.path().join("campaign").display().to_string();
    let path = path.display().to_string();
    let (exit, _, said) = run(&["import", &path, "--out", &campaign, "--allow-outside"]);
    assert!(
        exit == 0 && said.contains("finding: Q_1R") && said.contains("section not used]"),
        "{said}"
    );
}

#[test]
fn wrong_uses_are_refused() {
    let (exit, _, said) =
        run(&["import", "examples/foreign/mapping.yaml", "--out", "examples/foreign"]);
    assert!(exit == 2 && said.contains("output-is-input"), "{said}");
    let (exit, _, said) = run(&["import", "a.yaml", "b.yaml", "--out", "target/never"]);
    assert!(exit == 2 && said.contains("several-mappings"), "{said}");
    let (exit, _, said) =
        run(&["import", "examples/foreign/nothing.yaml", "--out", "target/never"]);
    assert!(exit == 2 && said.contains("file-missing"), "{said}");
    assert!(!Path::new("target/never").exists());
}
