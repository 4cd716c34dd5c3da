//! Input that would fill the memory or never end: each has a budget, and an error that says where
//! and what to do.
//!
//! The program runs with a bounded address space, in which it would be ended if it took what the
//! input asks for.

#![cfg(unix)]

use crate::common::campaign;
use crate::common::program;

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use program::{Ran, ran};
use tempfile::TempDir;

/// Runs the program with so many MB of address space.
#[track_caller]
fn within(megabytes: u64, arguments: &[&str]) -> Ran {
    let mut command = Command::new("sh");
    command.args([
        "-c",
        &format!("ulimit -v {}; exec \"$@\"", megabytes << 10),
        "sh",
        env!("CARGO_BIN_EXE_fishplate"),
    ]);
    ran(command.args(arguments).env_remove("NO_COLOR"))
}

/// What is said of a campaign of which one record was replaced.
#[track_caller]
fn of_record(megabytes: u64, write: impl FnOnce(&mut File, &str)) -> String {
    let tiny = campaign::tiny();
    let path = tiny.path().join("measurement/S01.csv");
    let header =
        fs::read_to_string(&path).expect("there").lines().next().expect("a header").to_string();
    write(&mut File::create(&path).expect("made"), &header);
    let out = tiny.path().join("out");
    let ran = within(
        megabytes,
        &[
            "certify",
            &tiny.path().display().to_string(),
            "--out",
            &out.display().to_string(),
            "--only",
            "results",
            "-j",
            "1",
        ],
    );
    assert!(ran.code < 2, "{} {}", ran.code, ran.stderr);
    let results: serde_json::Value =
        serde_json::from_slice(&fs::read(out.join("results.json")).expect("there")).expect("JSON");
    let section = results["sections"]
        .as_array()
        .expect("a list")
        .iter()
        .find(|section| section["section"] == "S01")
        .expect("there");
    section["reason"].as_str().expect("not used").to_string()
}

/// Address space of a small run, in MB, threads and their stacks among it.
const SMALL: u64 = 400;

#[test]
fn a_cell_of_many_megabytes() {
    let reason = of_record(SMALL, |file, header| {
        write!(file, "{header}\n0.00,0.000,").expect("written");
        for _ in 0..64 {
            file.write_all(&vec![b'1'; 1 << 20]).expect("written");
        }
    });
    assert!(reason.contains("line 2 of `measurement/S01.csv` has more than 1 MB"), "{reason}");
}

#[test]
fn a_header_of_many_megabytes() {
    let reason =
        of_record(SMALL, |file, _| file.write_all(&b"x,".repeat(100 << 20)).expect("written"));
    assert!(reason.contains("line 1 of `measurement/S01.csv` has more than 1 MB"), "{reason}");
}

/// Neither is read to its end: there is no first line.
#[test]
fn a_hole_on_the_disk_and_zeros() {
    let reason = of_record(SMALL, |file, _| file.set_len(256 << 20).expect("set"));
    assert!(reason.contains("has more than 1 MB"), "{reason}");
    let reason = of_record(SMALL, |file, _| file.write_all(&vec![0; 100 << 20]).expect("written"));
    assert!(reason.contains("has more than 1 MB"), "{reason}");
}

#[test]
fn a_hole_below_a_good_header() {
    // The allocator sets addresses aside before it uses them.
    let reason = of_record(512 + SMALL, |file, header| {
        writeln!(file, "{header}").expect("written");
        file.set_len(256 << 20).expect("set");
    });
    assert!(reason.contains("line 2 of `measurement/S01.csv` has more than 1 MB"), "{reason}");
}

#[test]
fn a_record_that_is_larger_than_any() {
    let reason = of_record(SMALL, |file, _| file.set_len((256 << 20) + 1).expect("set"));
    assert!(reason.contains("the maximum is 256 MB"), "{reason}");
}

/// A record is read in blocks: less memory than it is long is enough to say what is wrong.
#[test]
fn a_hole_is_told_with_little_memory() {
    let reason = of_record(SMALL, |file, header| {
        writeln!(file, "{header}").expect("written");
        file.set_len(256 << 20).expect("set");
    });
    assert!(reason.contains("line 2 of `measurement/S01.csv` has more than 1 MB"), "{reason}");
}

#[test]
fn a_record_cut_off_inside_its_last_number() {
    let tiny = campaign::tiny();
    let path = tiny.path().join("measurement/S01.csv");
    let text = fs::read_to_string(&path).expect("there");
    let reason_of = |text: &str| {
        fs::write(&path, text).expect("written");
        program::certify(tiny.path(), &["--only", "results"]).reason("S01")
    };
    let whole = text.trim_end();
    assert_eq!(reason_of(whole), None, "without a line break at its end");
    for cut in 1..5 {
        let reason =
            reason_of(&whole[..whole.len() - cut]).unwrap_or_else(|| panic!("{cut} cut off"));
        assert!(reason.contains("ends without a line break, in a number with"), "{reason}");
    }
}

/// A protocol with something put in for another text.
fn protocol(from: &str, to: &str) -> (TempDir, String) {
    let temp = tempfile::tempdir().expect("a temporary folder");
    let text = &fishplate::library::shipped("sprague-geers").expect("shipped").text;
    assert!(text.contains(from), "{from}");
    let path = temp.path().join("p.fp");
    let text = text.replacen("protocol sprague-geers", "protocol own", 1);
    fs::write(&path, text.replacen(from, to, 1)).expect("written");
    let path = path.display().to_string();
    (temp, path)
}

#[track_caller]
fn refused(from: &str, to: &str, code: &str, says: &str) {
    let (_temp, path) = protocol(from, to);
    let ran = within(SMALL, &["check", &path]);
    assert_eq!(ran.code, 2, "{to}: {}", ran.stderr);
    assert!(
        ran.stderr.contains(&format!("error[{code}]")) && ran.stderr.contains(says),
        "{}",
        ran.stderr
    );
}

#[test]
fn filters_that_double_each_other() {
    let doubled =
        |at: usize| format!("filter F{at} \"x\"\n  step  F{}\n  step  F{}\n\n", at - 1, at - 1);
    let all: String = (1..=40).map(doubled).collect();
    let all =
        format!("filter F0 \"x\"\n  step  low-pass 20 Hz, order 2, zero-phase\n\n{all}verdict");
    refused("verdict", &all, "too-large", "there can be at most 32");
    // Thirty-two steps are not too many.
    let all: String = (1..=5).map(doubled).collect();
    let all =
        format!("filter F0 \"x\"\n  step  low-pass 20 Hz, order 2, zero-phase\n\n{all}verdict");
    let (_temp, path) = protocol("verdict", &all);
    assert_eq!(within(SMALL, &["check", &path]).code, 0);
}

#[test]
fn places_with_many_positions() {
    let members =
        |count: usize| (0..count).map(|at| format!("b{at}")).collect::<Vec<_>>().join(", ");
    let place = |count: usize| format!("place box\n  members  {}\n\nchannel Y", members(count));
    refused("channel Y", &place(501), "too-large", "there can be at most 500");
    refused("channel Y", &place(100_000), "too-deep", "more than 2000 words");
    let (_temp, path) = protocol("channel Y", &place(500));
    assert_eq!(within(SMALL, &["check", &path]).code, 0);
}

#[test]
fn steps_that_are_too_fine() {
    for (step, says) in [
        ("1e-5 m", "is finer than 0.0001 m"),
        ("1e-12 m", "the step is below 1 µm"),
        ("0.01 mm", "is finer than 0.0001 m"),
    ] {
        let resampled = format!("filter FINE \"x\"\n  step  resample every {step}\n\nverdict");
        refused("verdict", &resampled, "out-of-range", says);
    }
    let resampled = "filter FINE \"x\"\n  step  resample every 0.1 mm\n\nverdict";
    let (_temp, path) = protocol("verdict", resampled);
    let ran = within(SMALL, &["check", &path]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
}

#[test]
fn numbers_that_are_none() {
    refused("each {part}_limit", "each 1e400", "not-finite", "too large for a number");
    refused("each {part}_limit", "each 0.1 / 0", "not-finite", "zero");
}

/// Families whose texts grow with their members, and more members than are written out.
#[test]
fn families_that_are_too_large() {
    let members =
        |count: usize| (0..count).map(|at| format!("m{at}")).collect::<Vec<_>>().join(", ");
    let family = |count: usize, note: &str| {
        format!(
            "define x_{{x}}\n  for each  x in {}\n  is        1\n  note      \"{note}\"\n\nverdict",
            members(count)
        )
    };
    refused(
        "verdict",
        &family(1001, "{x}"),
        "too-large",
        "has 1001 members; there can be at most 1000",
    );
    refused(
        "verdict",
        &family(900, &"{x}".repeat(20_000)),
        "too-large",
        "longer than 20 megabytes",
    );
    let (_temp, path) = protocol("verdict", &family(1000, "{x}"));
    assert_eq!(within(SMALL, &["check", &path]).code, 0);
}

#[test]
fn a_protocol_of_many_megabytes() {
    let temp = tempfile::tempdir().expect("a temporary folder");
    let path = temp.path().join("p.fp");
    fs::write(&path, "# nothing\n".repeat(11 << 20)).expect("written");
    let path = path.display().to_string();
    for arguments in [&["check", &path][..], &["fmt", "--check", &path], &["explain", &path]] {
        let ran = within(SMALL, arguments);
        assert!(ran.code == 2 && ran.stderr.contains("it has more than 2 MB"), "{}", ran.stderr);
    }
}

#[test]
fn a_table_with_an_endless_line() {
    let tiny = campaign::tiny();
    campaign::lines(&tiny.path().join("sections.csv"), |lines| lines.push("x".repeat(1 << 20)));
    let out = tiny.path().join("out").display().to_string();
    let ran = within(
        SMALL,
        &["certify", &tiny.path().display().to_string(), "--out", &out, "--only", "results"],
    );
    assert!(
        ran.code == 2 && ran.stderr.contains("error[line-too-long]"),
        "{}",
        &ran.stderr[..ran.stderr.len().min(2000)]
    );
    assert!(ran.stderr.len() < 2000);
}

#[test]
fn more_jobs_than_any_machine_has_cores() {
    let tiny = campaign::tiny();
    let out = tiny.path().join("out").display().to_string();
    let ran = within(
        SMALL,
        &["certify", &tiny.path().display().to_string(), "--out", &out, "--jobs", "5000"],
    );
    assert!(
        ran.code == 2 && ran.stderr.contains("`--jobs 5000` exceeds the maximum of 256"),
        "{}",
        ran.stderr
    );
}

/// The number of threads may stand in the environment, too.
#[test]
fn more_threads_than_any_machine_has_cores() {
    let tiny = campaign::tiny();
    let path = tiny.path().display().to_string();
    let out = tiny.path().join("out").display().to_string();
    let with = |arguments: &[&str]| {
        ran(program::program().args(arguments).env("RAYON_NUM_THREADS", "100000"))
    };
    for arguments in [
        &["certify", &path, "--out", &out][..],
        &["convert-records", &path, "--to", "parquet", "--out", &out],
        &["judge", "none", "--out", &out],
    ] {
        let ran = with(arguments);
        let says = "`RAYON_NUM_THREADS=100000` exceeds the maximum of 256";
        assert!(ran.code == 2 && ran.stderr.contains(says), "{}", ran.stderr);
    }
    let ran = with(&["certify", &path, "--out", &out, "--only", "results", "--jobs", "2"]);
    assert!(ran.code < 2, "{}", ran.stderr);
}

/// A text for the import is read as a whole; what is too large is told before it is read.
#[test]
fn a_text_for_the_import_that_is_too_large() {
    let temp = tempfile::tempdir().expect("a temporary folder");
    let file = File::create(temp.path().join("S01.csv")).expect("made");
    file.set_len((256 << 20) + 1).expect("set");
    let mapping = "name: x\nsections: [S01]\nmeasurement:\n  files: '{section}.csv'\n  time: t\n  channels: {a: a}\n";
    fs::write(temp.path().join("m.yaml"), mapping).expect("written");
    let path = |name: &str| temp.path().join(name).display().to_string();
    let ran = within(SMALL, &["import", &path("m.yaml"), "--out", &path("out")]);
    let says = "S01.csv` has 256 MB; the maximum is 256 MB";
    assert!(ran.code == 2 && ran.stderr.contains(says), "{}", ran.stderr);
}

/// Each value of results takes memory, and a map more of it.
#[test]
fn results_of_many_values() {
    let temp = tempfile::tempdir().expect("a temporary folder");
    let path = temp.path().join("results.json");
    for (value, count) in [("[]", 1_000_001), ("{\"a\":1}", 250_001)] {
        let values = vec![value; count].join(",");
        fs::write(&path, format!("{{\"fishplate\":\"1\",\"a\":[{values}]}}")).expect("written");
        let ran = within(SMALL, &["verify", &path.display().to_string()]);
        let says = "results.json` is not a results file of `certify`: more than 2000000 values";
        assert!(ran.code == 2 && ran.stderr.contains(says), "{}", ran.stderr);
    }
}

/// The example's vehicle with one number changed, on one of its tracks.
#[track_caller]
fn simulated(change: impl FnOnce(&Path), says: &str) {
    let coach = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("examples/coach");
    let temp = tempfile::tempdir().expect("a temporary folder");
    for file in ["vehicle.yaml", "profile.csv", "profile_worn.csv", "track/S13.csv"] {
        fs::copy(coach.join(file), temp.path().join(Path::new(file).file_name().expect("a name")))
            .expect("copied");
    }
    change(temp.path());
    let path = |name: &str| temp.path().join(name).display().to_string();
    let (vehicle, track, out) = (path("vehicle.yaml"), path("S13.csv"), path("out.csv"));
    let ran = within(
        SMALL,
        &["simulate", "--vehicle", &vehicle, "--track", &track, "--speed", "70 km/h", "-o", &out],
    );
    assert!(ran.code >= 2 && ran.stderr.contains(says), "{} {}", ran.code, ran.stderr);
    assert!(!Path::new(&out).exists());
}

#[test]
fn a_vehicle_that_weighs_more_than_the_earth() {
    simulated(
        |folder| campaign::replace(&folder.join("vehicle.yaml"), "mass: 32000.0", "mass: 1e30"),
        "mass",
    );
}

#[test]
fn a_vehicle_that_weighs_nothing() {
    simulated(
        |folder| campaign::replace(&folder.join("vehicle.yaml"), "mass: 1813.0", "mass: 1e-30"),
        "error",
    );
}
