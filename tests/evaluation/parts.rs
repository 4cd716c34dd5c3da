//! Campaigns evaluated in parts: `reduce` and `judge` give the bytes that `certify` gives, and what
//! does not belong together is refused.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::common::campaign::{copy, lines, replace, tiny};
use crate::common::program::{Ran, files, fishplate, program};
use fishplate::data::Campaign;
use fishplate::problem::Problems;
use fishplate::run::{Settings, Shard};
use fishplate::values::{self, ReduceJob, Values};
use serde_json::Value;
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn text(path: &Path) -> String {
    path.display().to_string()
}

/// All files below a folder by their path in it.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let inside = |path: &PathBuf| text(path.strip_prefix(folder).expect("below"));
    files(folder).iter().map(|path| (inside(path), fs::read(path).expect("readable"))).collect()
}

/// The files of values of all parts.
fn parts(folder: &Path, campaigns: &[&str], more: &[&str], of: usize) -> Vec<String> {
    let one = |number: usize| {
        let out = text(&folder.join(format!("values-{number}-{of}.parquet")));
        let shard = format!("{number}/{of}");
        let ran = fishplate(
            &[&["reduce"], campaigns, more, &["--shard", &shard, "--out", &out]].concat(),
        );
        assert_eq!(ran.code, 0, "{}{}", ran.stdout, ran.stderr);
        out
    };
    (0..of).map(one).collect()
}

fn judged(folder: &Path, values: &[String], more: &[&str]) -> (Ran, PathBuf) {
    let out = folder.join("judged");
    let values: Vec<&str> = values.iter().map(String::as_str).collect();
    let ran = fishplate(&[&["judge"], &values[..], more, &["--out", &text(&out)]].concat());
    (ran, out)
}

/// The whole, and for 1 to 20 parts in another order each.
#[track_caller]
fn same_bytes(campaigns: &[&str], more: &[&str]) {
    let folder = folder();
    let whole = folder.path().join("whole");
    let certified = fishplate(&[&["certify"], campaigns, more, &["--out", &text(&whole)]].concat());
    assert!(certified.code < 2, "{}", certified.stderr);
    let expected = contents(&whole);
    // More parts than sections: some are empty.
    for of in [1, 3, 20] {
        let mut values = parts(folder.path(), campaigns, more, of);
        values.rotate_left(of / 2);
        values.swap(0, of - 1);
        // The PDF takes most of the time: once.
        let only: &[&str] = if of == 3 { &[] } else { &["--only", "html"] };
        let (ran, out) = judged(folder.path(), &values, only);
        assert_eq!((ran.code, &ran.stdout), (certified.code, &certified.stdout), "{}", ran.stderr);
        let found = contents(&out);
        let of_pdf =
            |name: &str| name == "report.pdf" || name == "statement.json" || name.starts_with('.');
        for (name, bytes) in expected.iter().filter(|(name, _)| of == 3 || !of_pdf(name)) {
            assert!(found.get(name) == Some(bytes), "{campaigns:?} in {of} parts: {name} differs");
        }
        fs::remove_dir_all(out).expect("removed");
    }
}

#[test]
fn a_comparison_in_parts() {
    same_bytes(&["examples/coach"], &[]);
}

#[test]
fn found_sections_in_parts() {
    same_bytes(&["examples/run"], &[]);
}

/// Machines may see a campaign under different paths.
#[test]
fn parts_of_a_campaign_in_two_places() {
    let (campaign, folder) = (copy(Path::new("examples/coach")), folder());
    let places = [
        "examples/coach".to_string(),
        text(campaign.path()),
        "examples/../examples/coach".to_string(),
    ];
    let mut values = Vec::new();
    for (number, place) in places.iter().enumerate() {
        let out = text(&folder.path().join(format!("of-{number}.parquet")));
        let ran = fishplate(&["reduce", place, "--shard", &format!("{number}/3"), "--out", &out]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        values.push(out);
    }
    // One of the parts once more, from elsewhere.
    let again = text(&folder.path().join("again.parquet"));
    assert_eq!(fishplate(&["reduce", &places[1], "--shard", "0/3", "--out", &again]).code, 0);
    values.push(again);
    let whole = folder.path().join("whole");
    let certified =
        fishplate(&["certify", "examples/coach", "--only", "results", "--out", &text(&whole)]);
    let (ran, out) = judged(folder.path(), &values, &["--only", "results"]);
    assert_eq!(ran.code, certified.code, "{}", ran.stderr);
    let results = |of: &Path| fs::read(of.join("results.json")).expect("results");
    assert!(results(&out) == results(&whole));
}

#[test]
fn an_assessment_in_parts() {
    same_bytes(
        &["examples/coach"],
        &["--protocol", "en14363-on-track-assessment", "--set", "sections_per_zone=2"],
    );
}

#[test]
fn a_pool_in_parts() {
    same_bytes(&["examples/coach-good", "examples/coach"], &[]);
}

#[test]
fn repeats_and_several_models_in_parts() {
    same_bytes(&["examples/repeats"], &["--protocol", "kraft"]);
}

/// A part of which a record is missing; and the others.
#[test]
fn a_record_that_cannot_be_read_is_named_and_the_others_are_evaluated() {
    let (campaign, folder) = (copy(Path::new("examples/coach")), folder());
    fs::write(
        campaign.path().join("measurement/S05.csv"),
        "time [s],distance [m],Y_1R [kN]\n0,zero,1\n",
    )
    .expect("written");
    let path = text(campaign.path());
    let values = parts(folder.path(), &[&path], &[], 4);
    let out = text(&folder.path().join("again.parquet"));
    let ran = fishplate(&["reduce", &path, "--shard", "1/4", "--out", &out]);
    assert!(
        ran.code == 0
            && ran.stdout.contains("S05 not used: ")
            && ran.stdout.contains("values of 2 of 13 sections"),
        "{}",
        ran.stdout
    );
    let (ran, judged) = judged(folder.path(), &values, &["--only", "results"]);
    let whole = folder.path().join("whole");
    let certified = fishplate(&["certify", &path, "--only", "results", "--out", &text(&whole)]);
    assert_eq!((ran.code, &ran.stdout), (certified.code, &certified.stdout));
    assert!(contents(&judged) == contents(&whole));
}

#[test]
fn missing_values_are_told_and_nothing_is_assessed() {
    let folder = folder();
    let values = parts(folder.path(), &["examples/coach-good"], &[], 4);
    let (ran, out) = judged(
        folder.path(),
        &[values[3].clone(), values[0].clone(), values[2].clone()],
        &["--only", "results"],
    );
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    let says = "values of 3 of 13 sections are missing: S05, S06, S07";
    assert!(
        ran.stdout.contains("Verdict: not assessable") && ran.stdout.contains(says),
        "{}",
        ran.stdout
    );
    let results: Value = serde_json::from_slice(&contents(&out)["results.json"]).expect("JSON");
    assert_eq!(results["verdict"], "not assessable");
    let reasons = results["reasons"].as_array().expect("a list");
    assert!(reasons.iter().any(|reason| reason == says), "{reasons:?}");
    assert_eq!(results["sections"][3]["reason"], "its values are missing");
    // A part without any section is no fault.
    let empty = parts(folder.path(), &["examples/coach-good"], &[], 14);
    let (ran, _) = judged(folder.path(), &empty, &["--only", "results"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
}

#[test]
fn values_that_are_given_twice_are_told() {
    let folder = folder();
    let mut values = parts(folder.path(), &["examples/coach"], &[], 2);
    let again = text(&folder.path().join("copy.parquet"));
    fs::copy(&values[0], &again).expect("copied");
    values.push(again);
    let whole = parts(folder.path(), &["examples/coach"], &[], 1);
    let (ran, out) = judged(folder.path(), &values, &["--only", "results"]);
    assert!(
        ran.code == 1
            && ran.stderr.contains("warning[values-twice]")
            && ran.stderr.contains("copy.parquet"),
        "{}",
        ran.stderr
    );
    let found = contents(&out);
    // The same sections in other parts are the same values.
    values.extend(whole.iter().cloned());
    for values in [&whole, &values] {
        assert_eq!(judged(folder.path(), values, &["--only", "results"]).0.code, 1);
        assert!(contents(&out)["results.json"] == found["results.json"]);
    }
}

#[track_caller]
fn refused(folder: &Path, values: &[&str], says: &str) {
    let values: Vec<String> = values.iter().map(ToString::to_string).collect();
    let (ran, out) = judged(folder, &values, &["--only", "results"]);
    assert_eq!(ran.code, 2, "{}{}", ran.stdout, ran.stderr);
    assert!(ran.stderr.contains(says), "{says}: {}", ran.stderr);
    assert!(!out.exists(), "nothing is written");
}

#[test]
fn values_that_do_not_belong_together_are_refused() {
    let (campaign, folder) = (tiny(), folder());
    let path = text(campaign.path());
    let reduced = |name: &str, more: &[&str]| {
        let out = text(&folder.path().join(name));
        let ran = fishplate(&[&["reduce"], more, &["--out", &out]].concat());
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        out
    };
    let first = reduced("first.parquet", &[&path, "--shard", "0/2"]);
    let second = reduced("second.parquet", &[&path, "--shard", "1/2"]);
    let protocol = reduced("protocol.parquet", &[&path, "--shard", "1/2", "--protocol", "kraft"]);
    refused(folder.path(), &[&first, &protocol], "is of the protocol en14363-2016-annex-t.fp, ");
    let parameter = reduced(
        "parameter.parquet",
        &[&path, "--shard", "1/2", "--set", "lowpass_frequency=15 Hz"],
    );
    refused(
        folder.path(),
        &[&first, &parameter],
        "the parameter `lowpass_frequency` is 20 Hz (default) in `",
    );
    let other = reduced("other.parquet", &["examples/coach", "--shard", "1/2"]);
    refused(folder.path(), &[&first, &other], "is of the campaign Tiny, ");
    // A record that was changed after it was evaluated, in a section that two files have.
    lines(&campaign.path().join("measurement/S01.csv"), |lines| {
        lines.pop();
    });
    let changed = reduced("changed.parquet", &[&path]);
    refused(
        folder.path(),
        &[&first, &second, &changed],
        "has other values of section S01 than a file before it",
    );
    replace(
        &campaign.path().join("vehicle.yaml"),
        "static_wheel_load: 50",
        "static_wheel_load: 51",
    );
    let vehicle = reduced("vehicle.parquet", &[&path, "--shard", "1/2"]);
    refused(folder.path(), &[&first, &vehicle], "the campaign was changed between");
    // Not files of values.
    refused(folder.path(), &[&first, "examples/coach/sections.csv"], "is not a file of values");
    refused(
        folder.path(),
        &[&first, "examples/run/records/north-track.parquet"],
        "is a Parquet file, but not one of values",
    );
    refused(folder.path(), &[&first, "nowhere.parquet"], "there is no file");
    assert_eq!(fishplate(&["reduce", &path, "--shard", "2/2", "--out", &first]).code, 2);
}

/// The values of [`tiny`] with what they are written by.
fn tiny_values(shard: Shard) -> (fishplate::certify::Compiled, Values) {
    let (folder, mut problems) = (tiny(), Problems::default());
    let source = fishplate::library::find("en14363-2016-annex-t", None).expect("shipped");
    let family =
        fishplate::check::family::read(&source, &fishplate::library::parent, &mut problems);
    let compiled =
        fishplate::certify::compile(family, &Default::default(), &mut problems).expect("compiled");
    let campaign = Campaign::open(folder.path(), &mut problems).expect("a campaign");
    let opened = fishplate::certify::Opened {
        compiled,
        campaigns: vec![campaign],
        overrides: Default::default(),
        found: Vec::new(),
    };
    let values =
        values::reduce(&opened, ReduceJob { shard, plots: true }, &|_| {}).expect("reduced");
    (opened.compiled, values)
}

#[test]
fn values_of_another_version_are_refused() {
    let (compiled, values) = tiny_values(Shard::WHOLE);
    let bytes = values::write(&compiled.plan, &Values { program: "0.0.9".into(), ..values })
        .expect("bytes");
    let problem = values::read("old.parquet", bytes).expect_err("another version");
    assert_eq!(problem.code, "values-version");
    let this = env!("CARGO_PKG_VERSION");
    assert_eq!(
        problem.says,
        format!("`old.parquet` was written by fishplate 0.0.9, this is {this}")
    );
}

/// The same values in the table as in the metadata, and numbers that come back to the last bit.
#[test]
fn values_come_back_to_the_last_bit() {
    let (compiled, values) = tiny_values(Shard { number: 1, of: 3 });
    let bytes = values::write(&compiled.plan, &values).expect("bytes");
    assert!(
        bytes == values::write(&compiled.plan, &values).expect("bytes"),
        "the same values, the same bytes"
    );
    let mut problems = Problems::default();
    let read = values::read("v.parquet", bytes.clone()).expect("values");
    let joined = values::join(vec![read], &mut problems).expect("joined");
    let found: Vec<_> =
        joined.sections().iter().map(|(number, section)| (*number, section.rows.clone())).collect();
    let expected: Vec<_> =
        values.sections.iter().map(|(number, section)| (*number, section.rows.clone())).collect();
    assert_eq!(found, expected);
    assert!(
        found.iter().map(|(_, rows)| rows.iter().map(Vec::len).sum::<usize>()).sum::<usize>() > 100
    );
}

/// A file that was damaged is an error; one that was changed and sealed again, as no accident does,
/// does not end the program either.
#[test]
fn damaged_values_are_an_error_and_never_a_panic() {
    let (compiled, values) = tiny_values(Shard { number: 0, of: 4 });
    let bytes = values::write(&compiled.plan, &values).expect("bytes");
    for length in (0..bytes.len()).step_by(bytes.len() / 97) {
        let problem = values::read("v.parquet", bytes[..length].to_vec()).expect_err("cut off");
        assert!(["values-unreadable", "values-damaged"].contains(&problem.code), "{problem:?}");
    }
    let mut sound = 0;
    for at in (0..bytes.len()).step_by(bytes.len() / 499) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (at % 8);
        assert!(values::read("v.parquet", damaged.clone()).is_err(), "byte {at}");
        let begin = memchr::memmem::rfind(&damaged, b"zeros: ").map(|begin| begin + 7);
        let Some(begin) = begin.filter(|begin| begin + 64 <= damaged.len()) else { continue };
        damaged[begin..begin + 64].fill(b'0');
        values::seal::close(&mut damaged);
        let mut problems = Problems::default();
        let joined = values::read("v.parquet", damaged)
            .ok()
            .and_then(|file| values::join(vec![file], &mut problems));
        sound += usize::from(
            joined.is_some_and(|joined| joined.certification(Settings { traces: 8 }).is_ok()),
        );
    }
    assert!(sound < 400, "{sound}");
}

/// The study of sections needs no records either; what reads them again does.
#[test]
fn sections_are_studied_from_values() {
    let folder = folder();
    let values = parts(folder.path(), &["examples/coach"], &[], 3);
    let values: Vec<&str> = values.iter().map(String::as_str).collect();
    let (whole, of_parts) = (folder.path().join("whole"), folder.path().join("parts"));
    let study = |of: &[&str], out: &Path| {
        fishplate(&[&["study", "sections"], of, &["--out", &text(out)]].concat())
    };
    let (first, second) = (study(&["examples/coach"], &whole), study(&values, &of_parts));
    assert_eq!((first.code, &first.stdout), (second.code, &second.stdout), "{}", second.stderr);
    assert!(contents(&whole) == contents(&of_parts));
    let missing = study(&values[1..], &whole);
    assert!(
        missing.code == 2 && missing.stderr.contains("values of 4 of 13 sections are missing"),
        "{}",
        missing.stderr
    );
    let refused = fishplate(&[&["study", "sync"], &values[..], &["--out", &text(&whole)]].concat());
    assert!(
        refused.code == 2 && refused.stderr.contains("files of values contain none"),
        "{}",
        refused.stderr
    );
}

/// Killed at any time: there is no file, or the whole file.
#[test]
fn a_part_that_is_killed_leaves_no_half_file() {
    let folder = folder();
    let expected = fs::read(&parts(folder.path(), &["examples/coach"], &[], 1)[0]).expect("values");
    let out = folder.path().join("killed.parquet");
    let mut left_over = 0;
    for milliseconds in (0..400).step_by(20) {
        let mut child = program()
            .args(["reduce", "examples/coach", "--out"])
            .arg(&out)
            .spawn()
            .expect("started");
        std::thread::sleep(Duration::from_millis(milliseconds));
        child.kill().expect("killed");
        child.wait().expect("ended");
        if out.exists() {
            left_over += 1;
            assert!(
                fs::read(&out).expect("readable") == expected,
                "a half file after {milliseconds} ms"
            );
            fs::remove_file(&out).expect("removed");
        }
    }
    let ran = fishplate(&["reduce", "examples/coach", "--out", &text(&out)]);
    assert!(
        ran.code == 0 && fs::read(&out).expect("values") == expected,
        "{left_over} were complete"
    );
}
