//! Import of whole runs: the campaign that it makes, and the drift of the distance that it
//! corrects. The recorder of `examples/run/recorded` counts `0.00074 (s - s0) + 0.6 sin(2 pi (s -
//! s0) / 3300)` m too much, and its clock is 50 ppm fast.

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
    imported_from(text, Path::new(FOLDER), out)
}

fn imported_from(text: &str, folder: &Path, out: &Path) -> Problems {
    let (problems, done) = imported(text, "mapping.yaml", folder, out);
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
    for part in [
        "section: north",
        "drift of the distance by correlation of 23 channels",
        "corrected along the run",
        "time divided by 1 + 0.000050",
    ] {
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
    let [told, corrected] =
        [&told, &corrected].map(|folder| axes(&folder.join("measurement/north.csv")));
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

/// The clock is told from the corrected distance: 50 ppm without the correction of the mapping,
/// nothing with it.
#[test]
fn the_drift_of_the_clock_is_told() {
    let out = tempfile::tempdir().expect("a folder");
    let ppm = |text: &str, name: &str| -> f64 {
        let folder = out.path().join(name);
        imported_as(text, &folder);
        let origin = fs::read_to_string(folder.join("origin.yaml")).expect("the account");
        let (_, rest) =
            origin.split_once("at the same places: ").unwrap_or_else(|| panic!("{origin}"));
        rest.split(' ').next().and_then(|number| number.parse().ok()).expect("a number")
    };
    let without = ppm(&mapping().replace("{from: time, drift: 50 ppm}", "time"), "without");
    let with = ppm(&mapping(), "with");
    assert!((without - with - 50.0).abs() <= 1.0, "{without} {with}");
}

/// A run of 8 km with two channels, recorded with a clock that is 50 ppm fast and a wheel sensor
/// that counts up to 7 m too much. The simulation has the recorded speed.
fn long_run(folder: &Path, simulated_speed: f64) {
    let wave = |x: f64, which: f64| {
        (0.31 * x + which).sin()
            + 0.6 * (0.117 * x + 2.0 * which).sin()
            + 0.3 * (0.73 * x + which).cos()
    };
    let place = |time: f64| 40.0 * time + 200.0 * (time / 100.0).sin();
    let write = |name: &str, row: &dyn Fn(f64) -> [f64; 4]| {
        let rows = (0..20_000).map(|row| f64::from(row) * 0.01).map(row);
        let rows = rows.map(|[t, x, y, a]| format!("{t:.9},{x:.6},{y:.6},{a:.6}\n"));
        let text = "t [s],s [m],Y_1R [kN],ay_I [m/s^2]\n".to_string() + &rows.collect::<String>();
        fs::write(folder.join(name), text).expect("written");
    };
    write("measured.csv", &|time| {
        let x = place(time);
        [time * (1.0 + 50e-6), x + 0.0008 * x + 0.5 * (x / 900.0).sin(), wave(x, 0.0), wave(x, 1.0)]
    });
    write("simulated.csv", &|time| {
        [time / simulated_speed, place(time), wave(place(time), 0.0), wave(place(time), 1.0)]
    });
}

const LONG: &str = "name: long
runs: [R]
measurement:
  files: measured.csv
  time: t
  distance: s
  drift: {do: correct, clock: correct}
  channels: as named
simulation:
  files: simulated.csv
  time: t
  distance: s
  channels: as named
";

/// 50 ppm within 2 ppm; then the times are those of the true clock within 0.5 ms, in place of 10
/// ms.
#[test]
fn the_drift_of_the_clock_is_corrected_where_asked() {
    let folder = tempfile::tempdir().expect("a folder");
    long_run(folder.path(), 1.0);
    let out = folder.path().join("out");
    let (problems, done) = imported(LONG, "mapping.yaml", folder.path(), &out);
    assert!(done, "{}", problems.render(false));
    let origin = fs::read_to_string(out.join("origin.yaml")).expect("the account");
    let (_, rest) =
        origin.split_once("; time divided by 1 + ").unwrap_or_else(|| panic!("{origin}"));
    let drift: f64 = rest
        .split(['"', '\'', '\n'])
        .next()
        .and_then(|number| number.parse().ok())
        .expect("a number");
    assert!((drift - 50e-6).abs() < 2e-6, "{drift}");
    let corrected = axes(&out.join("measurement/R.csv"));
    let worst = corrected
        .iter()
        .enumerate()
        .map(|(row, (time, _))| (time - row as f64 * 0.01).abs())
        .fold(0.0, f64::max);
    assert!(corrected.len() == 20_000 && worst < 0.5e-3, "{worst}");
    // Only told, the time is as recorded.
    for told in ["{do: correct, clock: tell}", "correct"] {
        let out = folder.path().join("told");
        imported_from(&LONG.replace("{do: correct, clock: correct}", told), folder.path(), &out);
        let origin = fs::read_to_string(out.join("origin.yaml")).expect("the account");
        assert!(origin.contains("+50 ppm") && origin.contains("nothing was corrected"), "{origin}");
        assert!(
            (axes(&out.join("measurement/R.csv"))[19_999].0 - 199.99 * (1.0 + 50e-6)).abs() < 1e-6
        );
    }
}

/// A simulation at another speed says nothing about the clock, nor does a run of 2 km.
#[test]
fn a_clock_that_cannot_be_compared_is_not_corrected() {
    let folder = tempfile::tempdir().expect("a folder");
    long_run(folder.path(), 1.01);
    let (problems, done) =
        imported(LONG, "mapping.yaml", folder.path(), &folder.path().join("out"));
    let text = problems.render(false);
    let parts = [
        "no-drift",
        "run `R`: the drift of the clock cannot be estimated",
        "run with the recorded speed",
        "time: {drift: 50 ppm}",
    ];
    assert!(!done && parts.iter().all(|part| text.contains(part)), "{text}");
    let short = mapping().replace("drift: correct", "drift: {do: tell, clock: correct}");
    let (problems, done) =
        imported(&short, "mapping.yaml", Path::new(FOLDER), &folder.path().join("short"));
    let text = problems.render(false);
    assert!(!done && text.contains("standard error"), "{text}");
    let wrong = LONG.replace("clock: correct", "clock: corect");
    let (problems, done) =
        imported(&wrong, "mapping.yaml", folder.path(), &folder.path().join("wrong"));
    let text = problems.render(false);
    assert!(
        !done
            && text.contains("`clock` cannot be `corect`")
            && text.contains("did you mean `correct`"),
        "{text}"
    );
}

#[test]
fn what_does_not_fit_runs_is_told() {
    let out = tempfile::tempdir().expect("a folder");
    let says = |change: &dyn Fn(&str) -> String, parts: &[&str]| {
        let folder = out.path().join("never");
        let (problems, done) =
            imported(&change(&mapping()), "mapping.yaml", Path::new(FOLDER), &folder);
        let text = problems.render(false);
        assert!(!done && parts.iter().all(|part| text.contains(part)), "{text}");
        assert!(!folder.exists());
    };
    let with = |from: &'static str, to: &'static str| move |text: &str| text.replace(from, to);
    says(&with("{country: DE}", "{contry: DE}"), &["missing-run-data", "did you mean `contry`"]);
    says(
        &with("north: {country: DE}", "north:"),
        &["missing-run-data", "state it of the run: `north: {country: ...}`"],
    );
    says(
        &with("protocol: en14363-2016-annex-t-found-sections", "protocol: en14363-2016-annex-t"),
        &["no-search", "use found sections"],
    );
    says(
        &with("north: {country: DE}", "north: {country: DE, drift: corect}"),
        &["unknown-choice", "did you mean `correct`"],
    );
    says(&with("drift: correct", "drift: mend"), &["unknown-choice"]);
    says(
        &with("drift: correct", "drift: {do: correct, within: 20 m, window: 30 m}"),
        &["out-of-range", "at least 40 m"],
    );
    says(
        &with("drift: correct", "drift: {do: correct, within: 0.2 m}"),
        &["no-drift", "needs a larger `within`"],
    );
    says(&with("drift: correct", "drift: {within: 20 m}"), &["key-missing", "`do`"]);
    says(
        &with("{run}-track", "{section}-track"),
        &["unknown-placeholder", "`{section}` is not `{run}`"],
    );
    says(
        &with("vehicle:", "margin: 60 m\nvehicle:"),
        &["contradiction", "a run is kept as a whole"],
    );
    says(&with("  north: {country: DE}", "  a/b: {country: DE}"), &["path-outside"]);
    says(&with("  north: {country: DE}", "  south: {country: DE}"), &["file-missing"]);
    says(&with("runs:\n  north: {country: DE}", "runs: []"), &["wrong-kind", "R1, R2"]);
    says(&with("runs:\n  north: {country: DE}", "runs: [north, north]"), &["duplicate-name"]);
    // A drift stands with the measurement of a run.
    let simulated = "  files: ../records/{run}-simulated.parquet";
    says(
        &|text: &str| text.replace(simulated, &format!("{simulated}\n  drift: tell")),
        &["contradiction", "move it to `measurement`"],
    );
}
