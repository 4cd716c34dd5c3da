//! Any machine with a simulator: from two pairs of records to a diagnosis, with a Python function
//! as the simulator.

#![allow(clippy::cast_precision_loss)]

use std::f64::consts::PI;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::program::{Ran, program, ran};
use serde_json::Value;

/// A drive of 20 kg with friction that its simulation lacks.
const VISCOUS: f64 = 200.0;
const COULOMB: f64 = 20.0;
const RATE: f64 = 200.0;

/// Whether Python is there; tests that need it say so and end.
pub fn has_python() -> bool {
    let found = Command::new("python3")
        .arg("-c")
        .arg("pass")
        .output()
        .is_ok_and(|output| output.status.success());
    if !found {
        crate::common::tools::skip("python3");
    }
    found
}

/// Simulated and measured record of a run: five oscillations, noise from a fixed sequence.
fn pair(folder: &Path, run: usize, seconds: f64) -> [PathBuf; 2] {
    let mut state = 12345 + run as u64;
    let mut noise = || {
        let mut sum = 0.0;
        for _ in 0..4 {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            sum += (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
        }
        sum
    };
    let (mut simulated, mut measured) = (
        String::from("time [s],force [N]\n"),
        String::from("time [s],force [N],x [m],v [m/s],a [m/s^2]\n"),
    );
    for n in 0..(seconds * RATE) as usize {
        let t = n as f64 / RATE;
        let (mut x, mut v, mut a) = (0.0, 0.0, 0.0);
        for (k, f) in [0.31, 0.7, 1.3, 2.9, 5.3].into_iter().enumerate() {
            let (w, phase) = (2.0 * PI * f, run as f64 + 1.7 * k as f64);
            let size = 0.04 / (1.0 + f) * (1.0 + 0.5 * (0.05 * t).sin());
            x += size * (w * t + phase).sin();
            v += size * w * (w * t + phase).cos();
            a -= size * w * w * (w * t + phase).sin();
        }
        let _ = writeln!(simulated, "{t},{:.4}", 20.0 * a);
        let force = 20.0 * a + VISCOUS * v + COULOMB * f64::signum(v) + 2.0 * noise();
        let _ = writeln!(measured, "{t},{force:.4},{x:.7},{v:.7},{a:.7}");
    }
    let paths = ["sim", "meas"].map(|side| folder.join(format!("{side}{run}.csv")));
    fs::write(&paths[0], simulated).expect("written");
    fs::write(&paths[1], measured).expect("written");
    paths
}

/// `simulate` filled in as an engineer would, without NumPy.
const FILLED: &str = "
    force = []
    for x, v, a in zip(inputs['x'], inputs['v'], inputs['a']):
        sign = 1.0 if v > 0 else -1.0
        force.append((20.0 + parameters['mass']) * a + parameters['viscous'] * v + parameters['coulomb'] * sign
                     + parameters['stiffness'] * x)
    return {'force': force}
";

pub struct Machine {
    folder: tempfile::TempDir,
}

impl Machine {
    /// `new` for a drive.
    fn new(runs: usize, seconds: f64) -> Self {
        Self::of("drive", runs, &|folder, run| pair(folder, run, seconds))
    }

    /// `new` for a kind of machine, from pairs of records that are written into a folder.
    pub fn of(domain: &str, runs: usize, pair: &dyn Fn(&Path, usize) -> [PathBuf; 2]) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut command = program();
        command.current_dir(folder.path()).args(["new", "axis", "--domain", domain]);
        for run in 0..runs {
            command.arg("--from").args(pair(folder.path(), run));
        }
        let done = ran(&mut command);
        assert_eq!(done.code, 0, "{}{}", done.stdout, done.stderr);
        Self { folder }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join("axis").join(name)
    }

    pub fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub fn change(&self, name: &str, from: &str, to: &str) {
        let text = self.text(name);
        assert!(text.contains(from), "{name} has no `{from}`:\n{text}");
        fs::write(self.path(name), text.replacen(from, to, 1)).expect("written");
    }

    /// The sections of a record.
    fn sections_of(&self, record: &str) -> Vec<String> {
        let table = self.text("sections.csv");
        let rows = table.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>());
        rows.filter(|cells| cells[1] == record).map(|cells| cells[0].to_string()).collect()
    }

    /// Fills in the stub.
    pub fn fill(&self, body: &str) {
        self.change(
            "simulator.py",
            "    raise NotImplementedError(\"fill in `simulate` in simulator.py\")\n",
            body.trim_start_matches('\n'),
        );
    }

    fn run(&self, words: &[&str]) -> Ran {
        ran(program().current_dir(self.path("")).args(words))
    }

    pub fn diagnose(&self, more: &[&str]) -> Ran {
        let words = [
            "diagnose",
            ".",
            "--effects",
            "effects.yaml",
            "--simulator",
            "sim.yaml",
            "--cache",
            "cache",
        ];
        self.run(&[&words[..], more].concat())
    }

    #[track_caller]
    fn fails(&self, code: i32, says: &[&str]) {
        let done = self.diagnose(&["--out", "out"]);
        assert_eq!(done.code, code, "{}{}", done.stdout, done.stderr);
        for word in says {
            assert!(done.stderr.contains(word), "no `{word}` in\n{}", done.stderr);
        }
        assert!(!self.path("out").exists());
    }
}

#[test]
fn what_is_written_checks_and_certifies_at_once() {
    let machine = Machine::new(2, 40.0);
    let checked = machine.run(&["check", "protocol.fp"]);
    assert_eq!(checked.code, 0, "{}", checked.stderr);
    assert_eq!(machine.run(&["fmt", "--check", "protocol.fp"]).code, 0, "not in canonical form");
    let effects = machine.run(&["effects", "effects.yaml"]);
    assert_eq!(effects.code, 0, "{}", effects.stderr);
    for name in ["viscous", "coulomb", "backlash", "gain", "offset", "delay", "saturation", "noise"]
    {
        assert!(effects.stdout.contains(name), "no {name} in\n{}", effects.stdout);
    }
    let done = machine.run(&["certify", ".", "--only", "results", "--out", "report"]);
    assert_eq!(done.code, 1, "{}", done.stderr);
    assert!(
        done.stdout.contains("Verdict: not validated") && !done.stdout.contains(" not used"),
        "{}",
        done.stdout
    );
    let table = machine.text("sections.csv");
    assert!(
        table.starts_with("section,record,start [s],end [s],mean speed [m/s],amplitude [m]\n"),
        "{table}"
    );
    assert!(
        table.lines().any(|line| line.starts_with("S01,R1,"))
            && table.lines().any(|line| line.contains(",R2,")),
        "{table}"
    );
}

/// The whole path: an unfilled stub stops with its own words, a filled one is diagnosed.
#[test]
fn a_filled_stub_is_diagnosed() {
    if !has_python() {
        return;
    }
    let machine = Machine::new(2, 40.0);
    machine.fails(
        3,
        &["error[simulator-failed]", "NotImplementedError: fill in `simulate`", "simulator.py:"],
    );
    machine.fill(FILLED);
    let first = machine.diagnose(&["--preflight"]);
    assert_eq!(first.code, 0, "{}", first.stderr);
    let line = |title: &str| {
        first
            .stdout
            .lines()
            .find(|line| line.contains(title))
            .unwrap_or_else(|| panic!("{title}: {}", first.stdout))
    };
    assert!(
        line("Viscous friction").contains("force") && line("Viscous friction").contains(" sd"),
        "{}",
        first.stdout
    );
    // This function knows no backlash.
    assert!(
        line("Backlash").contains("changes no feature by one sd")
            && line("Backlash").contains("does not use"),
        "{}",
        first.stdout
    );
    let done = machine.diagnose(&["--out", "out"]);
    assert!(matches!(done.code, 0 | 1), "{}{}", done.stdout, done.stderr);
    let found: Value = serde_json::from_str(&machine.text("out/diagnosis.json")).expect("JSON");
    // The truth, in the answer: both frictions, each within 5 %.
    let effects = found["causes"][0]["effects"].as_array().expect("effects");
    let size = |name: &str| {
        let effect = effects
            .iter()
            .find(|effect| effect["name"] == name)
            .unwrap_or_else(|| panic!("no {name}: {}", done.stdout));
        effect["parameters"][name]["value"].as_f64().expect("a number")
    };
    for (name, truth) in [("viscous", VISCOUS), ("coulomb", COULOMB)] {
        assert!((size(name) / truth - 1.0).abs() < 0.05, "{name} {}\n{}", size(name), done.stdout);
    }
    assert_eq!(effects.len(), 2, "{}", done.stdout);
    assert_eq!(found["held_out"]["named"], false);
    on_held_out(&machine, found["how"]["sections"].as_u64().expect("a number"));
}

/// The second record is held out: the fit has the sections of the first one, and the frictions
/// remove most of the gap on the others.
fn on_held_out(machine: &Machine, all: u64) {
    let campaign = machine.text("campaign.yaml");
    let says = |text: &str| {
        fs::write(machine.path("campaign.yaml"), format!("{campaign}\n{text}\n")).expect("written")
    };
    let out = machine.sections_of("R2");
    says("held out: record = R2");
    let done = machine.diagnose(&["--out", "out2", "--write-improved", "improved"]);
    assert!(matches!(done.code, 0 | 1), "{}{}", done.stdout, done.stderr);
    let found: Value = serde_json::from_str(&machine.text("out2/diagnosis.json")).expect("JSON");
    let held = &found["held_out"];
    assert_eq!((&held["named"], &held["what"]), (&true.into(), &"record = R2".into()));
    assert_eq!(held["sections"], Value::from(out.clone()));
    assert_eq!(found["how"]["sections"].as_u64(), Some(all - out.len() as u64));
    assert!(held["fraction_removed"].as_f64().is_some_and(|removed| removed > 0.8), "{held}");
    assert!(
        done.stdout.contains("held out by the campaign (record = R2) the gap decreases"),
        "{}",
        done.stdout
    );
    // The improved campaign has all sections.
    let certified = machine.run(&["certify", "improved", "--only", "results", "--out", "again"]);
    assert!(
        certified.code < 2 && !certified.stdout.contains(" not used"),
        "{}{}",
        certified.stdout,
        certified.stderr
    );
    for (text, says_so) in [
        ("held out: record is R2", "must name a column of the section table and its values"),
        ("held out: recrd = R2", "did you mean `record`?"),
        ("held out: record = R7", "no section has `R7` in the column `record`"),
        ("held out: record = R1, R2", "leaves no section for the fit"),
    ] {
        says(text);
        let refused = machine.diagnose(&["--out", "out3"]);
        assert_eq!(refused.code, 2, "{text}: {}", refused.stdout);
        assert!(
            refused.stderr.contains(says_so) && refused.stderr.contains("campaign.yaml:"),
            "{text}: {}",
            refused.stderr
        );
        assert!(!machine.path("out3").exists());
    }
}

#[test]
fn what_is_misspelt_stops_before_the_first_run() {
    if !has_python() {
        return;
    }
    let machine = Machine::new(1, 40.0);
    machine.fill(FILLED);
    machine.change("sim.yaml", "simulator: machine", "simulator: machin");
    machine.fails(
        2,
        &[
            "error[not-simulated]",
            "no effect of the catalogue `axis` has a parameter of the simulator `machin`",
            "`machine`",
        ],
    );
    machine.change("sim.yaml", "simulator: machin", "simulator: machine");
    machine.change("effects.yaml", "{machine: viscous}", "{machine: viskous}");
    machine.fails(
        2,
        &[
            "error[unknown-parameter]",
            "`machine` has no parameter `viskous`",
            "did you mean `viscous`",
            "effects.yaml:",
        ],
    );
    machine.change("effects.yaml", "{machine: viskous}", "{machine: viscous}");
    machine.change("vehicle.yaml", "coulomb: 0", "coulom: 0");
    machine.fails(
        2,
        &["error[key-missing]", "`coulomb`, for which the vehicle file has no value", "`coulom`"],
    );
}

/// Every failure of a function has its own words, and nothing is written.
#[test]
fn a_failed_run_stops_with_the_functions_own_message() {
    if !has_python() {
        return;
    }
    for (body, code, says) in [
        (
            "    return {'force': 3}\n",
            "simulator-failed",
            "`force` must be a list or an array of numbers, not int",
        ),
        (
            "    return {'force': [float('nan')] * len(inputs['x'])}\n",
            "simulator-failed",
            "`force` is nan at sample 0",
        ),
        ("    return {'force': [0.0]}\n", "simulator-output", "`force` has 1 samples"),
        (
            "    return {'forces': [0.0] * len(inputs['x'])}\n",
            "unknown-channel",
            "has no column `force`",
        ),
        ("    return {'force': inputs['y']}\n", "simulator-failed", "KeyError: 'y'"),
        (
            "    import sys\n    sys.stderr.write('licence expired')\n    sys.stderr.flush()\n    import os\n    os._exit(3)\n",
            "simulator-failed",
            "licence expired",
        ),
        ("    import time\n    time.sleep(60)\n", "simulator-timeout", "after 8 s"),
    ] {
        let machine = Machine::new(1, 20.0);
        // Loading Python and NumPy may take seconds on a busy machine.
        if code == "simulator-timeout" {
            machine.change("sim.yaml", "timeout: 1 min", "timeout: 8 s");
        }
        machine.fill(body);
        let done = machine.diagnose(&["--out", "out"]);
        assert!(matches!(done.code, 2 | 3), "{body}: {}{}", done.stdout, done.stderr);
        assert!(
            done.stderr.contains(&format!("error[{code}]")) && done.stderr.contains(says),
            "{body}: {}",
            done.stderr
        );
        assert!(!machine.path("out").exists());
    }
}

/// What a function prints does not mix with its answers; records are kept and found again, digit by
/// digit.
#[test]
fn a_function_may_print_and_its_records_are_kept() {
    if !has_python() {
        return;
    }
    let machine = Machine::new(1, 20.0);
    machine.fill(&format!("\n    print('a word', inputs['section']['section']){FILLED}"));
    let simulate = |out: &str| {
        let words = [
            "simulate",
            ".",
            "--effects",
            "effects.yaml",
            "--simulator",
            "sim.yaml",
            "--cache",
            "cache",
            "--effect",
            "viscous=30",
        ];
        machine.run(&[&words[..], &["--out", out]].concat())
    };
    let first = simulate("first");
    assert_eq!(first.code, 0, "{}", first.stderr);
    let second = simulate("second");
    assert!(
        first.stderr.contains("0 records from the cache") && second.stderr.contains("(0 calls"),
        "{}{}",
        first.stderr,
        second.stderr
    );
    assert_eq!(machine.text("first/simulation/S01.csv"), machine.text("second/simulation/S01.csv"));
}

#[test]
fn bands_and_sections_that_the_records_do_not_have_are_told() {
    let machine = Machine::new(1, 20.0);
    let bands = machine
        .text("effects.yaml")
        .lines()
        .find(|line| line.trim_start().starts_with("bands: ["))
        .expect("bands")
        .to_string();
    machine.change("effects.yaml", &bands, "  bands: [0.5, 1, 150]");
    machine.change("effects.yaml", &format!("bands: {}", bands.matches(',').count()), "bands: 2");
    let only = |more: &[&str]| {
        machine.run(&[&["diagnose", ".", "--effects", "effects.yaml"][..], more].concat())
    };
    let done = only(&["--out", "out"]);
    assert_eq!(done.code, 2, "{}", done.stderr);
    for word in ["error[band-above-nyquist]", "150", "above 100 Hz", "effects.yaml:"] {
        assert!(done.stderr.contains(word), "no `{word}` in\n{}", done.stderr);
    }
    // No simulator and no vehicle of the railway: nothing of its model is asked for.
    assert!(
        done.stderr.contains("warning[no-simulator]") && !done.stderr.contains("bogie"),
        "{}",
        done.stderr
    );
    machine.change("effects.yaml", "  bands: [0.5, 1, 150]", "  bands: [0.5, 1, 15]");
    let table = machine.text("sections.csv");
    let row = table.lines().nth(2).expect("a row").to_string();
    let cells: Vec<&str> = row.split(',').collect();
    let moved =
        row.replace(&format!(",{},{},", cells[2], cells[3]), &format!(",{},999,", cells[2]));
    machine.change("sections.csv", &row, &moved);
    let told = |ran: &Ran| {
        let all = format!("{}{}", ran.stdout, ran.stderr);
        all.lines().find(|line| line.contains("is not inside")).map(|line| {
            line.split_once("the section from").map_or("", |(_, rest)| rest).to_string()
        })
    };
    let (certified, diagnosed) = (
        machine.run(&["certify", ".", "--only", "results", "--out", "report"]),
        only(&["--preflight"]),
    );
    assert!(told(&diagnosed).is_none(), "the first section alone is looked at");
    let diagnosed = only(&["--out", "out"]);
    let (certified, diagnosed) = (told(&certified).expect("told"), told(&diagnosed).expect("told"));
    assert!(certified.starts_with(&diagnosed), "{certified}\n{diagnosed}");
}

/// A run with three times the motion and force of another: the ranges are from both, whichever is
/// given first.
#[test]
fn ranges_are_from_all_records() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let small = pair(folder.path(), 0, 40.0);
    let large = pair(folder.path(), 1, 40.0);
    for path in &large {
        let text = fs::read_to_string(path).expect("read");
        let mut lines = text.lines().map(str::to_string);
        let mut out = lines.next().expect("a head") + "\n";
        for line in lines {
            let (time, values) = line.split_once(',').expect("columns");
            let values = values
                .split(',')
                .map(|value| (3.0 * value.parse::<f64>().expect("a number")).to_string());
            let _ = writeln!(out, "{time},{}", values.collect::<Vec<_>>().join(","));
        }
        fs::write(path, out).expect("written");
    }
    let ranges = |name: &str, pairs: &[&[PathBuf; 2]]| -> Vec<String> {
        let mut command = program();
        command.current_dir(folder.path()).args(["new", name, "--domain", "drive"]);
        for pair in pairs {
            command.arg("--from").args(*pair);
        }
        let done = ran(&mut command);
        assert_eq!(done.code, 0, "{}{}", done.stdout, done.stderr);
        let text = fs::read_to_string(folder.path().join(name).join("effects.yaml")).expect("read");
        text.lines().filter(|line| line.contains("range:")).map(str::to_string).collect()
    };
    let both = ranges("both", &[&small, &large]);
    assert!(!both.is_empty());
    assert_eq!(both, ranges("turned", &[&large, &small]));
    assert_ne!(both, ranges("small", &[&small]));
}

/// Columns whose names become the same word, and of which none is a force: the vehicle file has no
/// data then.
#[test]
fn what_is_made_of_any_columns_can_be_evaluated() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut text = String::from("time [s],a-b [m],a_b [m]\n");
    for n in 0..4000 {
        let t = f64::from(n) / RATE;
        let _ = writeln!(text, "{t},{:.5},{:.5}", (2.0 * t).sin(), (3.1 * t).cos());
    }
    let (file, made, out) =
        (folder.path().join("ab.csv"), folder.path().join("made"), folder.path().join("out"));
    fs::write(&file, text).expect("written");
    let done = ran(program().arg("new").arg(&made).arg("--from").arg(&file).arg(&file));
    assert_eq!(done.code, 0, "{}", done.stderr);
    let done =
        ran(program().arg("certify").arg(&made).args(["--only", "results", "--out"]).arg(&out));
    assert!(done.code < 2, "{}", done.stderr);
}

#[test]
fn records_that_do_not_fit_are_refused_with_their_place() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let [sim, meas] = pair(folder.path(), 0, 20.0);
    let text = fs::read_to_string(&meas).expect("read");
    let new = |name: &str, text: &str| {
        let other = folder.path().join(format!("{name}.csv"));
        fs::write(&other, text).expect("written");
        let done = ran(program()
            .arg("new")
            .arg(folder.path().join(name))
            .arg("--from")
            .arg(&sim)
            .arg(&other));
        assert!(!folder.path().join(name).exists() || done.code == 0, "{name}");
        done
    };
    for (name, from, to, says) in [
        ("unitless", "force [N]", "force", "error[unit-missing]"),
        ("nameless", "force [N]", "power [N]", "error[no-common-channel]"),
        ("timeless", "time [s]", "t [s]", "error[no-time]"),
        ("other", "force [N]", "force [m]", "error[unit-mismatch]"),
        ("back", "\n0.01,", "\n0,", "error[time-not-increasing]"),
    ] {
        let done = new(name, &text.replacen(from, to, 1));
        assert!(done.code == 2 && done.stderr.contains(says), "{name}: {}", done.stderr);
    }
    // Every third row is missing: uneven steps are resampled, and this is said.
    let thinned: Vec<&str> =
        text.lines().enumerate().filter(|(at, _)| at % 3 != 2).map(|(_, line)| line).collect();
    let done = new("uneven", &(thinned.join("\n") + "\n"));
    assert!(
        done.code == 0
            && (done.stdout.clone() + &done.stderr).contains("uneven time steps, resampled"),
        "{}{}",
        done.stdout,
        done.stderr
    );
}
