//! `study` as called: what is written, the same bytes on any number of cores, and what is said of
//! wrong input.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

fn run(arguments: &[&str]) -> (i32, String, String) {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let output = Command::new(env!("CARGO_BIN_EXE_fishplate"))
        .args(arguments)
        .current_dir(root)
        .output()
        .expect("the program runs");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code().unwrap_or(-1), text(&output.stdout), text(&output.stderr))
}

fn study(kind: &str, out: &Path, more: &[&str]) -> (i32, String, String) {
    let out = out.display().to_string();
    let mut arguments = vec!["study", kind, "examples/coach", "--out", &out];
    arguments.extend(more);
    run(&arguments)
}

fn json(out: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(out.join("study.json")).expect("study.json"))
        .expect("JSON")
}

#[test]
fn sections_are_counted_and_written() {
    let out = tempfile::tempdir().expect("a folder");
    let (one, two) = (out.path().join("one"), out.path().join("two"));
    let (code, _, said) = study("sections", &one, &["--jobs", "1"]);
    assert_eq!(code, 0, "{said}");
    study("sections", &two, &["--jobs", "2", "--quiet"]);
    for name in [
        "study.json",
        "report.pdf",
        "report.html",
        "tables/spread.csv",
        "tables/importance.csv",
        "tables/worst.csv",
    ] {
        let [a, b] =
            [&one, &two].map(|folder| fs::read(folder.join(name)).expect("a written file"));
        assert!(a == b, "{name} is not the same");
    }
    let found = json(&one);
    let zones: u64 = found["sections_per_zone"]
        .as_object()
        .expect("zones")
        .values()
        .filter_map(Value::as_u64)
        .map(|n| n * (n - 1) * (n - 2) / 6)
        .product();
    assert_eq!(found["combinations"].as_u64(), Some(zones));
    assert_eq!(found["exact"], Value::Bool(true));
    let share = found["validated"].as_f64().expect("a count") / zones as f64;
    assert_eq!(found["share_validated"].as_f64(), Some(share));
    assert_eq!(found["quantities"].as_array().map(Vec::len), Some(12));
    // Without scatter of choice the spread holds the value of all sections.
    let html = fs::read_to_string(one.join("report.html")).expect("a page");
    assert!(html.contains("Influence of individual sections") && !html.contains("NaN"));
}

/// Of eight sections with two signals no selection has the 24 pairs that the protocol requires.
#[test]
fn selections_that_cannot_be_assessed_say_why() {
    let out = tempfile::tempdir().expect("a folder");
    let (code, said, _) =
        run(&["study", "sections", "examples/run", "--out", &out.path().display().to_string()]);
    let why = "has at most 16 pairs, and 24 are required.";
    assert!(
        code == 0 && said.contains("differs for all selections") && said.contains(why),
        "{said}"
    );
    assert!(json(out.path())["notes"].to_string().contains(why));
}

#[test]
fn offsets_of_nothing_change_nothing() {
    let out = tempfile::tempdir().expect("a folder");
    let (code, _, said) = study("sync", out.path(), &["--offsets=-1,5", "--quiet"]);
    assert_eq!(code, 0, "{said}");
    study("sections", &out.path().join("sections"), &["--quiet"]);
    let (found, sections) = (json(out.path()), json(&out.path().join("sections")));
    let offsets = found["offsets"].as_array().expect("offsets");
    assert_eq!(
        offsets.iter().map(|at| at["offset_m"].as_f64()).collect::<Vec<_>>(),
        [Some(-1.0), Some(0.0), Some(5.0)]
    );
    // Held filters, cut without shift, give the very numbers of a plain run.
    assert_eq!(offsets[1]["quantities"], sections["quantities"]);
    assert_eq!(offsets[1]["verdict_changes"], Value::Array(Vec::new()));
    let flips = &offsets[1]["selections_changed"];
    assert_eq!(
        (flips["share_no_longer_validated"].as_f64(), flips["share_newly_validated"].as_f64()),
        (Some(0.0), Some(0.0))
    );
    assert_eq!(flips["exact"], Value::Bool(true));
    assert_ne!(offsets[2]["quantities"], sections["quantities"]);
}

/// The selections of three of each zone's sections, counted from the table of sections, are the same
/// at every offset: what the study moves is no fault of the data.
#[test]
fn every_offset_has_the_sections_of_the_records() {
    let out = tempfile::tempdir().expect("a folder");
    let folder = out.path().display().to_string();
    let (code, said, _) = run(&["study", "sync", "examples/coach-good", "--out", &folder]);
    assert_eq!(code, 0, "{said}");
    let table = fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/coach-good/sections.csv"),
    )
    .expect("a table");
    let of_zone = |zone: &str| {
        let zones = table.lines().filter_map(|line| line.split(',').nth(1));
        zones.filter(|of| *of == zone).count() as u64
    };
    let selections: u64 =
        ["1", "2", "3", "4"].map(of_zone).iter().map(|n| n * (n - 1) * (n - 2) / 6).product();
    let found = json(out.path());
    let offsets = found["offsets"].as_array().expect("offsets");
    assert!(offsets.len() > 5 && selections > 1, "{}", offsets.len());
    for at in offsets {
        assert_eq!(at["combinations"].as_u64(), Some(selections), "{at}");
        assert!(at["lost"].as_array().is_none_or(Vec::is_empty), "{at}");
        assert_eq!(at["verdict_all_sections"], "validated");
    }
    assert!(said.contains("unchanged"), "{said}");
}

#[test]
fn parameters_say_which_choice_decides() {
    let out = tempfile::tempdir().expect("a folder");
    let vary = [
        "--vary",
        "variance_divisor=n-1, n",
        "--vary",
        "mean_limit_share=0.5..1.5 step 0.5",
        "--quiet",
    ];
    let (code, _, said) = study("parameters", out.path(), &vary);
    assert_eq!(code, 0, "{said}");
    let found = json(out.path());
    let values = |at: usize| found["parameters"][at]["values"].as_array().expect("values").clone();
    assert_eq!(values(0).len(), 2);
    assert_eq!(
        values(1).iter().map(|at| at["value"].as_str().unwrap_or("")).collect::<Vec<_>>(),
        ["0.5", "1", "1.5"]
    );
    assert_eq!(values(0)[0]["as_it_is"], Value::Bool(true));
    let of = |at: &Value, name: &str| {
        let all = at["statistics"].as_array().expect("statistics");
        all.iter()
            .find(|one| one["id"] == "Y_qst" && one["statistic"] == name)
            .and_then(|one| one["normalised"].as_f64())
            .expect("a value")
    };
    // Divided by n, a standard deviation is smaller; with three times the limit, a mean is a third
    // of it.
    assert!(of(&values(0)[1], "std") < of(&values(0)[0], "std"));
    assert!((of(&values(1)[0], "mean") / of(&values(1)[2], "mean") - 3.0).abs() < 1e-12);
}

/// What the protocol does not call a parameter is found by the words that lead to it.
#[test]
fn every_rule_can_be_varied() {
    let out = tempfile::tempdir().expect("a folder");
    let vary = [
        "--vary",
        "quantity Y_qst limit std=2.5..7.5 step 2.5 kN",
        "--vary",
        "define extreme_value is=larger of |p0.15|, |p99.85|; larger of |p5|, |p95|",
        "--vary",
        "zone 4 minimum length=70 m, 5000 m",
        "--vary",
        "sections_per_zone=2,3",
        "--quiet",
    ];
    let (code, _, said) = study("parameters", out.path(), &vary);
    assert_eq!(code, 0, "{said}");
    let found = json(out.path());
    let values = |at: usize| found["parameters"][at]["values"].as_array().expect("values").clone();
    let of = |at: &Value, id: &str, name: &str| {
        let all = at["statistics"].as_array().expect("statistics");
        all.iter()
            .find(|one| one["id"] == id && one["statistic"] == name)
            .and_then(|one| one["normalised"].as_f64())
            .expect("a value")
    };
    assert_eq!(found["parameters"][0]["as_it_is"], "5 kN");
    assert_eq!(values(0)[1]["as_it_is"], Value::Bool(true));
    // Three times the limit of the standard deviation, and with it that of the mean.
    for name in ["std", "mean"] {
        assert!(
            (of(&values(0)[0], "Y_qst", name) / of(&values(0)[2], "Y_qst", name) - 3.0).abs()
                < 1e-12
        );
    }
    // The percentile pair, which the whole definition gives.
    assert!(of(&values(1)[1], "Y_max", "std") != of(&values(1)[0], "Y_max", "std"));
    assert_eq!(of(&values(1)[1], "Q_max", "std"), of(&values(1)[0], "Q_max", "std"));
    // No section of the zone is as long as that: nothing can be said.
    assert_eq!(values(2)[1]["verdict"], "not assessable");
}

/// All limits of a statistic times a factor: each value is divided by it, shares of such a limit
/// too, and conditions stay.
#[test]
fn all_limits_of_a_statistic_are_scaled_at_once() {
    let out = tempfile::tempdir().expect("a folder");
    let (code, _, said) =
        study("parameters", out.path(), &["--vary", "every limit std=0.5..2 step 0.5", "--quiet"]);
    assert_eq!(code, 0, "{said}");
    let found = json(out.path());
    let values = found["parameters"][0]["values"].as_array().expect("values");
    let of = |at: &Value| -> Vec<f64> {
        at["statistics"]
            .as_array()
            .expect("statistics")
            .iter()
            .filter_map(|one| one["normalised"].as_f64())
            .collect()
    };
    let (as_it_is, factors) = (of(&values[1]), [0.5, 1.0, 1.5, 2.0]);
    assert_eq!((values[1]["as_it_is"].as_bool(), as_it_is.len()), (Some(true), 24));
    for (at, factor) in values.iter().zip(factors) {
        assert_eq!(at["value"], factor.to_string());
        for (scaled, base) in of(at).iter().zip(&as_it_is) {
            assert!((scaled * factor - base).abs() < 1e-12, "{factor}: {scaled} and {base}");
        }
    }
}

#[test]
fn wrong_input_is_told_and_nothing_is_written() {
    let out = tempfile::tempdir().expect("a folder");
    let folder = out.path().join("none");
    for (kind, more, says) in [
        ("sections", &["--take", "9"][..], "a selection takes 9"),
        ("sections", &["--width", "2"], "must be between 0 and 1"),
        ("sync", &["--offsets=5,x"], "`x` is not a number"),
        ("sync", &["--farthest", "-1"], ""),
        ("parameters", &["--vary", "lowpass_oder=2,4"], "did you mean `lowpass_order`?"),
        ("parameters", &["--vary", "filter_phase=zero-fase"], "did you mean `zero-phase`?"),
        ("parameters", &["--vary", "lowpass_order=99"], "outside the range"),
        ("parameters", &["--vary", "lowpass_order"], "has no `=`"),
        ("parameters", &["--vary", "lowpass_order=1..2"], "step"),
        ("parameters", &["--vary", "quantity Y_qs limit std=4 kN"], "did you mean `Y_qst`?"),
        (
            "parameters",
            &["--vary", "quantity Y_qst limit=4 kN"],
            "add the first words of one of them: `limit std 5 kN`",
        ),
        ("parameters", &["--vary", "quantity Y_qst limit std=4 m"], "write the limit in kN"),
        ("parameters", &["--vary", "every limit sdt=1"], "did you mean `std`?"),
        ("parameters", &["--vary", "every limit std=1 kN"], "is not a number above zero"),
        ("parameters", &["--vary", "every quantity=1"], "write `every limit std`"),
        (
            "parameters",
            &["--vary", "zone 4 minimum width=4 m"],
            "zone 4 has no rule `minimum width`",
        ),
    ] {
        let (code, _, said) = study(kind, &folder, more);
        assert_eq!(code, 2, "{more:?}: {said}");
        assert!(said.contains(says), "{more:?}: {said}");
        assert!(!folder.exists(), "{more:?}");
    }
}
