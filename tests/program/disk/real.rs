//! The program itself: killed at any moment, or short of memory.

use std::fs;
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::disk::injector::files;
use crate::disk::program::program;
use crate::disk::{campaign, program};

/// Killed by the system at moments of its run, over results of an earlier one.
#[cfg(unix)]
#[test]
fn killed_at_any_moment() {
    let tiny = campaign::tiny();
    let certify = |out: &std::path::Path, more: &[&str]| {
        let mut command = program();
        command
            .arg("certify")
            .arg(tiny.path())
            .arg("--out")
            .arg(out)
            .arg("-q")
            .args(more)
            .stderr(Stdio::null())
            .stdout(Stdio::null());
        command
    };
    let before = ["--only", "html", "--set", "lowpass_frequency=15 Hz"];
    let of = |more: &[&[&str]]| {
        let temp = tempfile::tempdir().expect("a temporary folder");
        more.iter().for_each(|more| {
            assert!(
                certify(temp.path(), more)
                    .status()
                    .expect("it runs")
                    .code()
                    .is_some_and(|code| code < 2)
            )
        });
        files(temp.path())
    };
    let now = ["--only", "results"];
    let (old, new) = (of(&[&before]), of(&[&before, &now]));
    let mut ends = [0; 3];
    for step in 0..40 {
        let temp = tempfile::tempdir().expect("a temporary folder");
        certify(temp.path(), &before).status().expect("it runs");
        let mut run = certify(temp.path(), &now).spawn().expect("it starts");
        std::thread::sleep(Duration::from_millis(3 * step));
        let _ = run.kill();
        run.wait().expect("it ended");
        let found = files(temp.path());
        let within = |set: &std::collections::BTreeMap<String, Vec<u8>>| {
            found.iter().all(|(name, bytes)| set.get(name) == Some(bytes))
        };
        let unfinished = temp.path().join(".fishplate-unfinished").is_dir();
        assert!(
            found == old || found == new || unfinished && (within(&old) || within(&new)),
            "{step}: {:?}",
            found.keys()
        );
        ends[if found == old {
            0
        } else if found == new {
            1
        } else {
            2
        }] += 1;
        assert!(
            certify(temp.path(), &now)
                .status()
                .expect("it runs")
                .code()
                .is_some_and(|code| code < 2)
        );
        assert_eq!(files(temp.path()), new);
        assert!(crate::disk::injector::leftovers(temp.path()).is_empty());
    }
    eprintln!("40 points: old {}, new {}, between {}", ends[0], ends[1], ends[2]);
}

/// With ever less memory, the program does its work, or says why not, or is ended by the system;
/// the old results stay whole.
#[cfg(target_os = "linux")]
#[test]
fn short_of_memory() {
    let tiny = campaign::tiny();
    let temp = tempfile::tempdir().expect("a temporary folder");
    let run = |limit: Option<u64>, more: &str| {
        let limit = limit.map_or(String::new(), |limit| format!("ulimit -v {limit}; "));
        let call = format!(
            "{limit}exec '{}' certify '{}' --out '{}' -q -j 1 {more}",
            env!("CARGO_BIN_EXE_fishplate"),
            tiny.path().display(),
            temp.path().display()
        );
        Command::new("sh")
            .args(["-c", &call])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status()
            .expect("it starts")
    };
    assert!(
        run(None, "--set 'lowpass_frequency=15 Hz' --only results")
            .code()
            .is_some_and(|code| code < 2)
    );
    let old = files(temp.path());
    let (mut done, mut ended) = (0, 0);
    for limit in (10_000..200_000).step_by(5_000) {
        let status = run(Some(limit), "--only results");
        if status.code().is_some_and(|code| code < 2) {
            done += 1;
            assert_ne!(files(temp.path()), old);
            assert!(
                run(None, "--set 'lowpass_frequency=15 Hz' --only results")
                    .code()
                    .is_some_and(|code| code < 2)
            );
        } else {
            ended += 1;
        }
        assert_eq!(files(temp.path()), old, "{limit} kB: {status}");
    }
    eprintln!("{} points of memory: {done} done, {ended} not", done + ended);
    assert!(done > 0 && ended > 0);
}

/// A folder that is read is not written to, whoever asks.
#[test]
fn records_are_not_overwritten() {
    let tiny = campaign::tiny();
    let before = files(tiny.path());
    let inside = |name: &str| tiny.path().join(name).display().to_string();
    let campaign = tiny.path().display().to_string();
    for (out, calls) in [
        ("measurement", &["certify", "study sections", "diagnose", "simulate"][..]),
        ("simulation", &["certify", "study sections", "diagnose", "simulate"]),
        ("measurement/new/deep", &["certify"]),
        ("", &["simulate"]),
    ] {
        for call in calls {
            let arguments: Vec<&str> = call.split(' ').collect();
            let ran = program::ran(
                program().args(&arguments).arg(&campaign).arg("--out").arg(inside(out)),
            );
            assert_eq!(ran.code, 2, "{call} {out}: {}", ran.stderr);
            assert!(ran.stderr.contains("output-is-input"), "{call} {out}: {}", ran.stderr);
            assert_eq!(files(tiny.path()), before, "{call} {out}");
        }
    }
    let improved = program::ran(program().args([
        "diagnose",
        &campaign,
        "--out",
        &inside("d"),
        "--write-improved",
        &campaign,
    ]));
    assert_eq!(
        (improved.code, improved.stderr.contains("output-is-input")),
        (2, true),
        "{}",
        improved.stderr
    );
    assert_eq!(files(tiny.path()), before);
    // A report beside the inputs takes nothing away from them, the second time as little as the
    // first.
    for only in ["html", "results"] {
        let ran = program::ran(
            program().args(["certify", &campaign, "--out", &campaign, "--only", only]),
        );
        assert!(ran.code < 2, "{}", ran.stderr);
    }
    let after = files(tiny.path());
    assert!(before.iter().all(|(name, bytes)| after.get(name) == Some(bytes)));
    assert!(after.contains_key("results.json") && !after.contains_key("report.html"));
}

/// Numbers alone, beside the report of another verdict.
#[test]
fn no_report_of_another_verdict_stays() {
    let tiny = campaign::tiny();
    let out = tempfile::tempdir().expect("a temporary folder");
    let certify = |only: &str| {
        let ran = program::ran(
            program()
                .arg("certify")
                .arg(tiny.path())
                .arg("--out")
                .arg(out.path())
                .args(["--only", only]),
        );
        assert!(ran.code < 2, "{}", ran.stderr);
    };
    certify("html");
    fs::write(out.path().join("remarks.txt"), "mine").expect("written");
    assert!(out.path().join("report.html").is_file());
    certify("results");
    assert!(!out.path().join("report.html").exists() && out.path().join("remarks.txt").is_file());
}

/// `fmt` of a good and a bad text.
#[test]
fn nothing_is_formatted_where_one_text_is_wrong() {
    let temp = tempfile::tempdir().expect("a temporary folder");
    let (good, bad) = (temp.path().join("good.fp"), temp.path().join("bad.fp"));
    let text =
        fishplate::library::shipped("sprague-geers").expect("shipped").text.replace("  ", "    ");
    fs::write(&good, &text).expect("written");
    fs::write(&bad, "quantity {{{\n").expect("written");
    let ran = program::ran(program().arg("fmt").arg(&good).arg(&bad));
    assert_eq!(ran.code, 2, "{}", ran.stderr);
    assert_eq!(fs::read_to_string(&good).expect("there"), text);
    assert_eq!(program::ran(program().arg("fmt").arg(&good)).code, 0);
    assert_ne!(fs::read_to_string(&good).expect("there"), text);
}

/// Characters that a terminal acts on, in names and titles.
#[test]
fn nothing_that_acts_is_printed() {
    let temp = tempfile::tempdir().expect("a temporary folder");
    let tiny = campaign::tiny();
    campaign::replace(
        &tiny.path().join("campaign.yaml"),
        "name: Tiny",
        "name: \"T\\e[31m\u{202e}iny\"",
    );
    let out = temp.path().join("o\u{1b}[2Jut\u{202e}");
    let text = fishplate::library::shipped("sprague-geers").expect("shipped").text.replacen(
        '"',
        "\"\u{202e}",
        1,
    );
    fs::write(temp.path().join("p.fp"), text).expect("written");
    let catalogue = "catalogue: x\ntitle: \"\u{202e}title\"\nextends: bogie-vehicle\n";
    fs::write(temp.path().join("c.yaml"), catalogue).expect("written");
    let nasty =
        |text: &str| text.chars().any(|c| c != '\n' && c != '\t' && fishplate::problem::acts(c));
    let calls = [
        program()
            .arg("certify")
            .arg(tiny.path())
            .arg("--out")
            .arg(&out)
            .args(["--only", "results"])
            .output(),
        program().arg("explain").arg(temp.path().join("p.fp")).output(),
        program().arg("explain").arg(temp.path().join("p.fp")).args(["--format", "json"]).output(),
        program().arg("effects").arg(temp.path().join("c.yaml")).output(),
        program().arg("check").arg(temp.path().join("\u{1b}[31m\u{202e}.fp")).output(),
        program().arg("\u{1b}[31m").output(),
    ];
    for (nth, output) in calls.into_iter().enumerate() {
        let output = output.expect("it runs");
        for bytes in [output.stdout, output.stderr] {
            let text = String::from_utf8(bytes).expect("UTF-8");
            assert!(!nasty(&text), "call {nth}: {text:?}");
        }
    }
}
