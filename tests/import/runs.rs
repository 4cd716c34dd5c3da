//! Import of whole runs: the campaign that it makes, and the drift of the distance that it corrects. The recorder of `examples/run/recorded`
//! counts `0.00074 (s - s0) + 0.6 sin(2 pi (s - s0) / 3300)` m too much, and its clock is 50 ppm fast.

use std::fs;
use std::path::Path;

use fishplate::problem::Problems;

use super::imported;

const MAPPING: &str = "examples/run/recorded/mapping.yaml";
const FOLDER: &str = "examples/run/recorded";

fn counted(s: f64) -> f64 {
    let from = s - 40.018_090_866;
    s + 0.000_74 * from + 0.6 * (std::f64::consts::TAU * from / 3300.0).sin()
}

/// Where the vehicle was when the sensor counted so much.
fn place(count: f64) -> f64 {
    (0..50).fold(count, |s, _| s - (counted(s) - count))
}

fn mapping() -> String {
    fs::read_to_string(MAPPING).expect("the example")
}

fn imported_as(text: &str, out: &Path) -> Problems {
    let (problems, done) = imported(text, "mapping.yaml", Path::new(FOLDER), out);
    assert!(done, "{}", problems.render(false));
    problems
}

/// Time and distance of a record.
fn axes(path: &Path) -> Vec<(f64, f64)> {
    let text = fs::read_to_string(path).expect("a record");
    let row = |line: &str| {
        let mut cells = line.split(',').map(|cell| cell.parse::<f64>().expect("a number"));
        (cells.next().expect("a time"), cells.next().expect("a distance"))
    };
    text.lines().skip(1).map(row).collect()
}

#[test]
fn a_run_becomes_a_campaign_with_runs() {
    let out = tempfile::tempdir().expect("a folder");
    let folder = out.path().join("c");
    imported_as(&mapping(), &folder);
    let yaml = fs::read_to_string(folder.join("campaign.yaml")).expect("a campaign");
    let runs = "runs:\n  north:\n    measurement: measurement/north.csv\n    simulation: simulation/north.csv\n    track: track/north.parquet\n    country: DE\n";
    assert!(yaml.contains(runs), "{yaml}");
    assert!(!yaml.contains("sections:"), "{yaml}");
    let track = fs::read(folder.join("track/north.parquet")).expect("the track");
    assert_eq!(track, fs::read("examples/run/records/north-track.parquet").expect("the track"));
    let origin = fs::read_to_string(folder.join("origin.yaml")).expect("the account");
    for part in
        ["section: north", "drift of the distance by correlation of 23 channels", "corrected along the run", "time divided by 1 + 0.000050"]
    {
        assert!(origin.contains(part), "no `{part}` in\n{origin}");
    }
    let mut problems = Problems::default();
    let campaign = fishplate::data::Campaign::open(&folder, &mut problems).expect("a campaign");
    assert_eq!((campaign.runs().len(), campaign.runs()[0].name.value.as_str()), (1, "north"));
}

/// 1.1 to 2.6 m become 0.08 m at most, with a root mean square of 0.04 m.
#[test]
fn the_drift_is_corrected_along_the_whole_run() {
    let out = tempfile::tempdir().expect("a folder");
    let (told, corrected) = (out.path().join("told"), out.path().join("corrected"));
    imported_as(&mapping().replace("drift: correct", "drift: tell"), &told);
    imported_as(&mapping(), &corrected);
    let [told, corrected] = [&told, &corrected].map(|folder| axes(&folder.join("measurement/north.csv")));
    assert_eq!(told.len(), corrected.len());
    let (mut worst, mut squares, mut before) = (0.0_f64, 0.0, f64::INFINITY);
    for ((_, count), (_, corrected)) in told.iter().zip(&corrected) {
        let error = corrected - place(*count);
        worst = worst.max(error.abs());
        squares += error * error;
        before = before.min((count - place(*count)).abs());
    }
    let rms = (squares / told.len() as f64).sqrt();
    assert!(before > 1.0 && worst < 0.12 && rms < 0.06, "{worst} {rms} {before}");
    assert!(corrected.windows(2).all(|pair| pair[1].1 > pair[0].1));
}

/// The clock is told from the corrected distance: 50 ppm without the correction of the mapping, nothing with it.
#[test]
fn the_drift_of_the_clock_is_told() {
    let out = tempfile::tempdir().expect("a folder");
    let ppm = |text: &str, name: &str| -> f64 {
        let folder = out.path().join(name);
        imported_as(text, &folder);
        let origin = fs::read_to_string(folder.join("origin.yaml")).expect("the account");
        let (_, rest) = origin.split_once("at the same places: ").unwrap_or_else(|| panic!("{origin}"));
        rest.split(' ').next().and_then(|number| number.parse().ok()).expect("a number")
    };
    let without = ppm(&mapping().replace("{from: time, drift: 50 ppm}", "time"), "without");
    let with = ppm(&mapping(), "with");
    assert!((without - with - 50.0).abs() <= 1.0, "{without} {with}");
}

#[test]
fn what_does_not_fit_runs_is_told() {
    let out = tempfile::tempdir().expect("a folder");
    let says = |change: &dyn Fn(&str) -> String, parts: &[&str]| {
        let folder = out.path().join("never");
        let (problems, done) = imported(&change(&mapping()), "mapping.yaml", Path::new(FOLDER), &folder);
        let text = problems.render(false);
        assert!(!done && parts.iter().all(|part| text.contains(part)), "{text}");
        assert!(!folder.exists());
    };
    let with = |from: &'static str, to: &'static str| move |text: &str| text.replace(from, to);
    says(&with("{country: DE}", "{contry: DE}"), &["missing-run-data", "did you mean `contry`"]);
    says(&with("north: {country: DE}", "north:"), &["missing-run-data", "state it of the run: `north: {country: IT}`"]);
    says(&with("protocol: en14363-2016-annex-t-found-sections", "protocol: en14363-2016-annex-t"), &["no-search", "use found sections"]);
    says(&with("north: {country: DE}", "north: {country: DE, drift: corect}"), &["unknown-choice", "did you mean `correct`"]);
    says(&with("drift: correct", "drift: mend"), &["unknown-choice"]);
    says(&with("drift: correct", "drift: {do: correct, within: 20 m, window: 30 m}"), &["out-of-range", "at least 40 m"]);
    says(&with("drift: correct", "drift: {do: correct, within: 0.2 m}"), &["no-drift", "needs a larger `within`"]);
    says(&with("drift: correct", "drift: {within: 20 m}"), &["key-missing", "`do`"]);
    says(&with("{run}-track", "{section}-track"), &["unknown-placeholder", "`{section}` is not `{run}`"]);
    says(&with("vehicle:", "margin: 60 m\nvehicle:"), &["contradiction", "a run is kept as a whole"]);
    says(&with("  north: {country: DE}", "  a/b: {country: DE}"), &["path-outside"]);
    says(&with("  north: {country: DE}", "  south: {country: DE}"), &["file-missing"]);
    says(&with("runs:\n  north: {country: DE}", "runs: []"), &["wrong-kind", "R1, R2"]);
    says(&with("runs:\n  north: {country: DE}", "runs: [north, north]"), &["duplicate-name"]);
    // A drift stands with the measurement of a run.
    let simulated = "  files: ../records/{run}-simulated.parquet";
    says(&|text: &str| text.replace(simulated, &format!("{simulated}\n  drift: tell")), &["contradiction", "move it to `measurement`"]);
}
