//! Gaps and uneven steps of time: nothing is invented, and the account tells what was done.

use std::fs;
use std::path::Path;

use fishplate::data::record::{Wanted, read_record};
use fishplate::problem::Problems;
use fishplate::units::Dimension;

use crate::import::imported;

const SECTIONS: &str = "section,start [m],end [m]\nS01,120,180\n";

/// A record at the times given: distance at 20 m/s, and a channel that is the distance as well.
fn record(folder: &Path, times: &[f64], decimals: usize) {
    fs::write(folder.join("sections.csv"), SECTIONS).expect("written");
    let row = |time: &f64| format!("{time:.decimals$};{0:.6};{0:.6}\n", 100.0 + 20.0 * time);
    let text: String = times.iter().map(row).collect();
    fs::write(folder.join("S01.txt"), format!("Zeit;Weg;a\ns;m;m\n{text}")).expect("written");
}

fn side(keys: &str) -> String {
    format!(
        "name: case\nsections: sections.csv\nmeasurement:\n  files: '{{section}}.txt'\n{keys}\n  channels: {{a: a}}\n"
    )
}

const AXES: &str = "  time: Zeit\n  distance: Weg";

fn import(folder: &Path, keys: &str) -> (Problems, bool) {
    let (problems, done) = imported(&side(keys), "mapping.yaml", folder, &folder.join("out"));
    assert_eq!(done, folder.join("out").exists());
    (problems, done)
}

fn even(rate: f64) -> Vec<f64> {
    (0..1200).map(|at| f64::from(at) / rate).collect()
}

/// Whatever the rate that is asked for, a record with a hole is not resampled.
#[test]
fn nothing_is_resampled_across_a_gap() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut times = even(200.0);
    times.drain(400..600);
    record(folder.path(), &times, 3);
    for keys in ["  rate: 200 Hz", "  rate: 100 Hz", "  rate: 400 Hz"] {
        let (problems, done) = import(folder.path(), &format!("{AXES}\n{keys}"));
        let text = problems.render(false);
        let gap = "section `S01`: the time of";
        let parts = [
            "error[gap]",
            gap,
            "gap of 1.005 s from 1.995 s to 3 s, after row 402, at 200 Hz otherwise",
            keys.trim(),
        ];
        assert!(!done && parts.iter().all(|part| text.contains(part)), "{keys}: {text}");
    }
    // A distance that is the integral of a speed would be invented as well.
    let (problems, done) = import(
        folder.path(),
        "  time: Zeit\n  distance: {from speed: Weg, start: 100 m}\n  units: {m: m/s}",
    );
    assert!(
        !done && problems.render(false).contains("integrated to a distance"),
        "{}",
        problems.render(false)
    );
    // Kept as recorded, the record has its gap, which the evaluation tells.
    assert!(import(folder.path(), AXES).1);
}

#[test]
fn uneven_stamps_come_to_even_steps_where_a_rate_is_stated() {
    let folder = tempfile::tempdir().expect("a folder");
    let times: Vec<f64> = even(200.0)
        .iter()
        .enumerate()
        .map(|(at, time)| time + 1e-3 * (1.7 * at as f64).sin())
        .collect();
    record(folder.path(), &times, 9);
    let (problems, done) = import(folder.path(), AXES);
    let text = problems.render(false);
    assert!(
        done && text.contains("warning[uneven-time]") && text.contains("time: {rate: 200 Hz}"),
        "{text}"
    );
    fs::remove_dir_all(folder.path().join("out")).expect("removed");
    let (problems, done) = import(folder.path(), &format!("{AXES}\n  rate: 200 Hz"));
    assert!(done && problems.0.is_empty(), "{}", problems.render(false));
    let wanted = [Wanted::new("time", Dimension::TIME), Wanted::new("a", Dimension::LENGTH)];
    let record = read_record(&folder.path().join("out/measurement/S01.csv"), "record", &wanted)
        .unwrap_or_else(|problems| panic!("{}", Problems(problems).render(false)));
    let (times, values) = (&record.columns[0].values, &record.columns[1].values);
    assert!(times.windows(2).all(|pair| (pair[1] - pair[0] - 0.005).abs() < 1e-9));
    assert!(
        times.iter().zip(values).all(|(time, value)| (value - 100.0 - 20.0 * time).abs() < 1e-5)
    );
    let account = fs::read_to_string(folder.path().join("out/origin.yaml")).expect("an account");
    assert!(
        account.contains("brought to even steps of 200 Hz") && !account.contains("windowed sinc"),
        "{account}"
    );
    assert!(!account.contains("(table ``)"), "{account}");
}

/// A filter needs even steps; the stated rate of the recorder is one way to them.
#[test]
fn uneven_stamps_are_not_filtered() {
    let folder = tempfile::tempdir().expect("a folder");
    let times: Vec<f64> = even(200.0)
        .iter()
        .enumerate()
        .map(|(at, time)| time + 1.4e-3 * (1.7 * at as f64).sin())
        .collect();
    record(folder.path(), &times, 9);
    let (problems, done) = import(folder.path(), &format!("{AXES}\n  rate: 50 Hz"));
    let text = problems.render(false);
    assert!(
        !done && text.contains("error[uneven-time]") && text.contains("time: {rate: 200 Hz}"),
        "{text}"
    );
    // Steps that are long, but shorter than two, may be those of inexact stamps as well.
    let longer: Vec<f64> = even(200.0)
        .iter()
        .enumerate()
        .map(|(at, time)| time + 2e-3 * (1.7 * at as f64).sin())
        .collect();
    record(folder.path(), &longer, 9);
    let (problems, done) = import(folder.path(), &format!("{AXES}\n  rate: 50 Hz"));
    let text = problems.render(false);
    assert!(
        !done && text.contains("error[gap]") && text.contains("time: {rate: 200 Hz}"),
        "{text}"
    );
    assert!(import(folder.path(), "  time: {rate: 200 Hz}\n  distance: Weg\n  rate: 50 Hz").1);
}

#[test]
fn more_samples_are_made_by_one_method() {
    let folder = tempfile::tempdir().expect("a folder");
    record(folder.path(), &even(200.0), 3);
    assert!(import(folder.path(), &format!("{AXES}\n  rate: 400 Hz")).1);
    let account = fs::read_to_string(folder.path().join("out/origin.yaml")).expect("an account");
    assert!(
        account.contains("resampled from 200 Hz to 400 Hz, 2399 rows (interpolated linearly)"),
        "{account}"
    );
    assert!(!account.contains("windowed sinc"), "{account}");
}

#[test]
fn stamps_in_whole_seconds_need_the_rate() {
    let folder = tempfile::tempdir().expect("a folder");
    let times: Vec<f64> = even(200.0).iter().map(|time| (time + 1e-9).floor()).collect();
    record(folder.path(), &times, 0);
    let (problems, done) = import(folder.path(), AXES);
    let text = problems.render(false);
    assert!(
        !done && text.contains("time-not-increasing") && text.contains("time: {rate: 200 Hz}"),
        "{text}"
    );
}

/// A stated rate and a column of time: the record has one time.
#[test]
fn a_record_has_one_time() {
    let folder = tempfile::tempdir().expect("a folder");
    record(folder.path(), &even(200.0), 3);
    let path = folder.path().join("S01.txt");
    let text = fs::read_to_string(&path).expect("the record").replace("Zeit", "time");
    fs::write(&path, text).expect("written");
    let text = side("  time: {rate: 200 Hz}\n  distance: Weg").replace("{a: a}", "as named");
    let (problems, done) =
        imported(&text, "mapping.yaml", folder.path(), &folder.path().join("out"));
    assert!(done, "{}", problems.render(false));
    let record =
        fs::read_to_string(folder.path().join("out/measurement/S01.csv")).expect("a record");
    assert!(record.starts_with("time [s],distance [m],a [m]\n"), "{}", &record[..60]);
    let account = fs::read_to_string(folder.path().join("out/origin.yaml")).expect("an account");
    assert!(account.contains("the channel `time` of the file is left out"), "{account}");
}

/// A rate that is wrong by orders of magnitude is told before it fills the memory.
#[test]
fn rates_that_are_none_of_the_records() {
    let folder = tempfile::tempdir().expect("a folder");
    record(folder.path(), &even(200.0), 3);
    for (rate, says) in [
        ("1e7 Hz", "more than 20 times that of"),
        ("1e9 Hz", "more than 20 times"),
        ("1e-9 Hz", "leaves no two samples"),
    ] {
        let (problems, done) = import(folder.path(), &format!("{AXES}\n  rate: {rate}"));
        let text = problems.render(false);
        assert!(
            !done && text.contains("error[out-of-range]") && text.contains(says),
            "{rate}: {text}"
        );
    }
    assert!(import(folder.path(), &format!("{AXES}\n  rate: 3900 Hz")).1);
}
