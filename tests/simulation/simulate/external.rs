//! Other simulators: the program itself is one, called for one record at a time.

use std::fs;
use std::time::Instant;

use super::{ACCELERATION, FORCE, Place, SECTIONS, channel};
use crate::simulate::program::files;

const FISHPLATE: &str = env!("CARGO_BIN_EXE_fishplate");

/// A catalogue that says which of the twin's parameters two effects move, one of them in another
/// unit.
const CATALOGUE: &str = "\
catalogue: twins
extends: bogie-vehicle
effects:
  friction:
    acts on: environment
    parameters:
      friction: {unit: '-', neutral: vehicle, default: 0.5, range: [0.05, 0.7], model: friction, simulators: {twin: friction}}
  payload:
    acts on: vehicle
    parameters:
      payload.mass:
        unit: t
        neutral: vehicle
        default: 4
        range: [0, 15]
        model: payload.mass
        simulators: {twin: {parameter: payload, factor: 1000}}
";

/// A place with a simulator `sim.yaml` whose command is given, and a cache of its own.
fn place(command: &str, more: &str) -> Place {
    let place = Place::new();
    place.write("twins.yaml", CATALOGUE);
    place.write("sim.yaml", &format!("simulator: twin\ncommand: {command}\n{more}"));
    place
}

fn twin() -> Place {
    let command = format!(
        "['{FISHPLATE}', simulate, --vehicle, '{{vehicle}}', --track, '{{track}}', --speed, '{{speed}} km/h', '{{set}}', -o, '{{out}}']"
    );
    place(&command, "set: [--effect, '{name}={value}']\nspeed unit: km/h\ntimeout: 60 s\n")
}

const USED: [&str; 4] = ["--simulator", "sim.yaml", "--effects", "twins.yaml"];
const CACHED: [&str; 2] = ["--cache", "cache"];

fn arguments<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&USED[..], &CACHED[..], more].concat()
}

/// Inside the section the records are those of the model, within the digits that are written: the
/// twin runs over the whole track.
#[test]
fn effects_reach_the_programs_parameters() {
    let place = twin();
    let effects = [
        "--effect",
        "friction=0.5 in zone 4",
        "--effect",
        "payload=3 t",
        "--effect",
        "sensor_gain=0.8 on Y_1R",
    ];
    place.simulated("direct", &effects);
    let ran = place.simulated("twin", &arguments(&effects));
    assert!(ran.stderr.contains("(4 calls of twin, 0 records from the cache)"), "{}", ran.stderr);
    for section in SECTIONS {
        let (direct, twin) = (place.record("direct", section), place.record("twin", section));
        for name in ["Y_1R", "Y_1L", "Q_3R", "ay_I"] {
            let mean = |signals: &fishplate::effects::Signals| {
                let inside = |n: &usize| (160.0..200.0).contains(&signals.axis[*n]);
                let at: Vec<usize> = (0..signals.axis.len()).filter(inside).collect();
                at.iter().map(|n| channel(signals, name)[*n]).sum::<f64>() / at.len() as f64
            };
            let digit = if name.starts_with('a') { 20.0 * ACCELERATION } else { 10.0 * FORCE };
            assert!(
                (mean(&direct) - mean(&twin)).abs() < digit,
                "{section} {name}: {} {}",
                mean(&direct),
                mean(&twin)
            );
        }
    }
}

/// What was made before is not made again: not for the same call, not for a copy of the campaign;
/// for other content it is.
#[test]
fn records_are_kept_by_content() {
    let place = twin();
    let effect = ["--effect", "friction=0.5 in zones 3, 4"];
    let told = |out: &str, expected: &str, more: &[&str]| {
        let ran = place.simulated(out, &arguments(&[&effect[..], more].concat()));
        assert!(ran.stderr.contains(expected), "{out}: {}", ran.stderr);
    };
    told("a", "4 calls of twin, 0 records", &[]);
    told("b", "0 calls of twin, 4 records", &[]);
    assert!(place.text("a/simulation/S13.csv") == place.text("b/simulation/S13.csv"));
    // One more zone: only its section is new.
    told("c", "1 calls of twin, 3 records", &["--effect", "friction=0.4 in zone 2"]);
    // A track changes: its section is new.
    let track = place.text("small/track/S10.csv");
    let last = track.lines().last().expect("a line").to_string();
    place
        .write("small/track/S10.csv", track.trim_end().strip_suffix(&last).expect("the last line"));
    told("d", "1 calls of twin, 3 records", &[]);
    // The vehicle or what it names: all are new.
    place.replace("small/vehicle.yaml", "mass: 32000.0", "mass: 32001.0");
    told("e", "4 calls of twin, 0 records", &[]);
    let profile = place.text("small/profile_worn.csv");
    place.write("small/profile_worn.csv", &format!("{profile}\n"));
    told("f", "4 calls of twin, 0 records", &[]);
    // A record in the cache that was damaged is made anew.
    let damaged = files(&place.path("cache")).into_iter().next().expect("a record");
    for file in files(&place.path("cache")) {
        fs::write(file, "time [s]\n0\n").expect("written");
    }
    told("g", "4 calls of twin, 0 records", &[]);
    assert!(damaged.is_file());
    let ran = place.simulated("h", &[&USED[..], &["--no-cache"]].concat());
    assert!(ran.stderr.contains("4 calls of twin, 0 records"), "{}", ran.stderr);
}

/// A job that stopped at a fault goes on where it stopped.
#[test]
fn a_job_resumes() {
    let place = twin();
    let table = place.text("small/sections.csv");
    place.write("small/sections.csv", &table.replace(",132.4", ",900"));
    let ran = place.simulate("out", &arguments(&[]));
    assert_eq!(ran.code, 3);
    // What the program said is shown, with section, exit code and command.
    for word in [
        "section `S01`: twin failed: exit status: 2",
        "outside the range of the model",
        "simulate --vehicle",
        "small/sections.csv:2:1",
    ] {
        assert!(ran.stderr.contains(word), "`{word}` is not in {}", ran.stderr);
    }
    place.write("small/sections.csv", &table);
    let ran = place.simulated("out", &arguments(&[]));
    assert!(ran.stderr.contains("1 calls of twin, 3 records from the cache"), "{}", ran.stderr);
}

#[test]
fn increments_and_baseline() {
    let place = twin();
    let ran = place.simulated(
        "increment",
        &arguments(&["--increment", "--baseline", "--effect", "friction=0.5"]),
    );
    assert!(
        ran.stderr.contains("baseline: twin deviates from the campaign's simulation by at most"),
        "{}",
        ran.stderr
    );
    // Without the effect, with it: the run for the baseline serves the increment too.
    assert!(ran.stderr.contains("(8 calls of twin, 4 records from the cache)"), "{}", ran.stderr);
    let direct = place.simulated("own", &["--increment", "--effect", "friction=0.5"]);
    assert_eq!(direct.code, 0);
    for section in SECTIONS {
        let (a, b) = (place.record("own", section), place.record("increment", section));
        assert_eq!(a.axis, b.axis);
        let pairs = channel(&a, "Y_1L").iter().zip(channel(&b, "Y_1L"));
        let rms = (pairs.map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / a.axis.len() as f64).sqrt();
        assert!(rms < 0.5, "{section}: {rms} kN");
    }
    fs::write(place.path("sim.yaml"), place.text("sim.yaml") + "tolerance: 0.01 %\n")
        .expect("written");
    let ran = place.simulated("warned", &arguments(&["--baseline"]));
    assert!(
        ran.stderr.contains("warning[baseline]") && ran.stderr.contains("more than 0.01 %"),
        "{}",
        ran.stderr
    );
}

/// The same bytes on any number of jobs.
#[test]
fn jobs() {
    let place = twin();
    place.simulated("one", &[&USED[..], &["--no-cache", "--jobs", "1"]].concat());
    place.simulated("two", &[&USED[..], &["--no-cache", "--jobs", "2"]].concat());
    for section in SECTIONS {
        let record = format!("simulation/{section}.csv");
        assert!(place.text(&format!("one/{record}")) == place.text(&format!("two/{record}")));
    }
}

#[test]
fn effects_that_the_program_cannot_add() {
    let place = twin();
    let ran = place.simulate("out", &arguments(&["--effect", "cant_error=20"]));
    assert_eq!(ran.code, 2, "{}", ran.stderr);
    assert!(
        ran.stderr.contains("the catalogue does not define how twin adds `track.cant_error`"),
        "{}",
        ran.stderr
    );
    place.replace("sim.yaml", ", '{set}'", "");
    place.replace("sim.yaml", "set: [--effect, '{name}={value}']\n", "");
    let ran = place.simulate("out", &arguments(&["--effect", "friction=0.5"]));
    assert_eq!(ran.code, 3, "{}", ran.stderr);
    assert!(ran.stderr.contains("`twin` accepts no parameters"), "{}", ran.stderr);
    let alone = [
        "simulate",
        "--vehicle",
        "small/vehicle.yaml",
        "--track",
        "t",
        "-o",
        "x.csv",
        "--speed",
        "20",
        "--simulator",
        "sim.yaml",
    ];
    assert_eq!(
        crate::simulate::program::fishplate(&alone).code,
        2,
        "one record is a call of the program itself"
    );
}

/// Programs of the system that do one thing each.
#[cfg(unix)]
mod programs {
    use super::*;

    #[track_caller]
    fn fails(place: &Place, words: &[&str]) {
        let ran = place.simulate("out", &arguments(&[]));
        assert_eq!(ran.code, 3, "{}", ran.stderr);
        for word in words {
            assert!(ran.stderr.contains(word), "`{word}` is not in {}", ran.stderr);
        }
        assert!(files(&place.path("cache")).is_empty(), "a record that is wrong was kept");
    }

    /// Also what the program started is ended: the shell waits for a child that would sleep for
    /// minutes.
    #[test]
    fn time_out() {
        let place = place(
            "[sh, -c, 'echo warming up >&2; sleep 300 & echo $! > child; wait', '{out}']",
            "timeout: 0.3 s\n",
        );
        let started = Instant::now();
        fails(
            &place,
            &["simulator-timeout", "section `S01`: twin was terminated after 0.3 s", "warming up"],
        );
        assert!(started.elapsed().as_secs() < 30);
        let child = place.text("child").trim().to_string();
        let gone = |_| {
            let state = fs::read_to_string(format!("/proc/{child}/stat"));
            let gone = state.map_or(true, |state| state.contains(") Z "));
            std::thread::sleep(std::time::Duration::from_millis(if gone { 0 } else { 50 }));
            gone
        };
        assert!(!cfg!(target_os = "linux") || (0..100).any(gone), "the child {child} goes on");
    }

    /// What left the group of the program is ended, too.
    #[cfg(target_os = "linux")]
    #[test]
    fn time_out_of_what_is_in_a_session_of_its_own() {
        if !std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default())
            .any(|folder| folder.join("setsid").is_file())
        {
            crate::common::tools::skip("setsid");
            return;
        }
        let command =
            r#"[sh, -c, 'setsid sh -c "echo \$\$ > child; exec sleep 300" & sleep 300', '{out}']"#;
        let place = place(command, "timeout: 1 s\n");
        fails(&place, &["simulator-timeout"]);
        let child = place.text("child").trim().to_string();
        let gone = |_| {
            let state = fs::read_to_string(format!("/proc/{child}/stat"));
            let gone = state.map_or(true, |state| state.contains(") Z "));
            std::thread::sleep(std::time::Duration::from_millis(if gone { 0 } else { 50 }));
            gone
        };
        assert!(!child.is_empty() && (0..100).any(gone), "the child {child} goes on");
    }

    /// Also if the program itself ends well: what it leaves in sessions of their own, also without
    /// the variable if their parent is running, ends with it.
    #[cfg(target_os = "linux")]
    #[test]
    fn what_a_program_leaves_behind_ends_with_it() {
        if !std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default())
            .any(|folder| folder.join("setsid").is_file())
        {
            crate::common::tools::skip("setsid");
            return;
        }
        let script = r#"setsid sh -c "echo \$\$ >> left; env -i sh -c \"echo \\\$\\\$ >> left; sleep 301\"; sleep 300" & while [ $(wc -l < left) -lt 2 ]; do sleep 0.02; done; cp small/simulation/$1.csv $2"#;
        let command = format!("[sh, -c, '{script}', sh, '{{section}}', '{{out}}']");
        let place = place(&command, "timeout: 20 s\n");
        place.write("left", "");
        place.simulated("out", &arguments(&["--jobs", "1"]));
        let left = place.text("left");
        assert!(left.lines().count() >= 2, "{left}");
        for child in left.lines() {
            let gone = |_| {
                let state = fs::read_to_string(format!("/proc/{child}/stat"));
                let gone = state.map_or(true, |state| state.contains(") Z "));
                std::thread::sleep(std::time::Duration::from_millis(if gone { 0 } else { 50 }));
                gone
            };
            assert!((0..100).any(gone), "the child {child} goes on");
        }
    }

    /// An entry of the cache that was changed is told, and its record made anew.
    #[test]
    fn a_damaged_cache() {
        let place = twin();
        let effects = ["--effect", "friction=0.5"];
        place.simulated("first", &arguments(&effects));
        let kept = files(&place.path("cache"));
        let entry = kept
            .iter()
            .find(|path| path.extension().is_some_and(|extension| extension == "csv"))
            .expect("kept")
            .clone();
        let text = fs::read_to_string(&entry).expect("there");
        fs::write(&entry, text.replacen('1', "2", 1)).expect("written");
        let ran = place.simulated("second", &arguments(&effects));
        assert!(ran.stderr.contains("warning[cache-damaged]"), "{}", ran.stderr);
        assert_eq!(fs::read_to_string(&entry).expect("there"), text);
        for section in SECTIONS {
            let record = |out: &str| place.text(&format!("{out}/simulation/{section}.csv"));
            assert_eq!(record("first"), record("second"), "{section}");
        }
    }

    #[test]
    fn exit_code_and_last_words() {
        let command = "[sh, -c, 'for n in 1 2 3 4 5 6 7 8 9 10 11 12; do echo line $n >&2; done; exit 7', '{out}']";
        fails(
            &place(command, ""),
            &["simulator-failed", "exit status: 7", "line 12", "line 5", "the command was: sh -c"],
        );
        let ran = place(command, "").simulate("out", &arguments(&[]));
        assert!(
            !ran.stderr.contains("line 4\n") && ran.stderr.contains("4 errors"),
            "{}",
            ran.stderr
        );
        fails(&place("[sh, -c, 'kill -9 $$', '{out}']", ""), &["simulator-failed", "signal: 9"]);
    }

    #[test]
    fn a_second_try() {
        // Fails the first time for each section.
        let script = "test -e tried-$1 && cp small/simulation/$1.csv $2 || (touch tried-$1; echo no licence >&2; exit 1)";
        let command = format!("[sh, -c, '{script}', sh, '{{section}}', '{{out}}']");
        let tried = place(&command, "retries: 1\n");
        let ran = tried.simulated("out", &arguments(&[]));
        assert!(ran.stderr.contains("8 calls of twin"), "{}", ran.stderr);
        assert!(tried.record("out", "S13") == tried.record("small", "S13"));
        fails(
            &place(&command.replace("tried-$1 &&", "never &&"), "retries: 2\n"),
            &["no licence", "(3 tries)"],
        );
    }

    #[test]
    fn no_record_and_wrong_records() {
        fails(
            &place("[sh, -c, ':', '{out}']", ""),
            &["simulator-output", "ended without an error, but wrote no record"],
        );
        let write = |script: &str| {
            place(
                &format!("[sh, -c, '{script}', sh, 'small/simulation/{{section}}.csv', '{{out}}']"),
                "",
            )
        };
        fails(&write("echo hello > $2"), &["section `S01`", "S01.csv of twin"]);
        fails(&write(": > $2"), &["section `S01`: the record of twin", "empty"]);
        fails(&write("sed s/Y_1R/Y_1X/ $1 > $2"), &["unknown-channel", "no column `Y_1R`"]);
        fails(&write("sed \"1s/Y_1R .kN./Y_1R [m]/\" $1 > $2"), &["unit-mismatch", "Y_1R"]);
        fails(&write("sed 40s/,[^,]*$/,NaN/ $1 > $2"), &["not-finite", "S01.csv of twin:40:"]);
        fails(&write("sed 40s/,[^,]*$// $1 > $2"), &["S01.csv of twin:40:"]);
        fails(
            &write("sed \"1s/distance/position/\" $1 > $2"),
            &["unknown-channel", "no column `distance`"],
        );
        fails(&write("head -n 2 $1 > $2"), &["too-short"]);
        fails(
            &write("head -n 40 $1 > $2"),
            &["simulator-output", "S01", "the record must cover the section"],
        );
    }

    /// Words are handed over as they are: no shell looks at them.
    #[test]
    fn no_shell() {
        let place = place("[printf, '%s', '$(touch made) ; touch made', '{out}']", "");
        let ran = place.simulate("out", &arguments(&[]));
        assert!(ran.stderr.contains("wrote no record"), "{}", ran.stderr);
        assert!(!place.path("made").exists());
    }

    #[test]
    fn environment_folder_and_placeholders() {
        let script =
            "printf \"%s\\n\" \"$KEY\" \"$PWD\" \"$@\" > said-$1; cp small/simulation/$1.csv $2";
        let command = format!(
            "[sh, -c, '{script}', sh, '{{section}}', '{{out}}', '{{start}}..{{end}}', 'v={{speed}}', '{{{{set}}}}']"
        );
        let place = place(&command, "environment: {KEY: some words}\nspeed unit: km/h\n");
        place.simulated("out", &arguments(&[]));
        let said = place.text("said-S13");
        let lines: Vec<&str> = said.lines().collect();
        assert_eq!(lines[0], "some words");
        assert_eq!(
            fs::canonicalize(lines[1]).expect("a folder"),
            fs::canonicalize(place.path("")).expect("a folder")
        );
        assert_eq!(lines[2], "S13");
        assert_eq!(&lines[4..], ["157.5..227.5", "v=67.2", "{set}"]);
    }

    /// Records in other units come in those of the campaign's simulation.
    #[test]
    fn units_of_the_campaign() {
        let script = "sed \"1s/Q_1R .kN./Q_1R [MN]/\" $1 > $2";
        let place = place(
            &format!("[sh, -c, '{script}', sh, 'small/simulation/{{section}}.csv', '{{out}}']"),
            "",
        );
        place.simulated("out", &arguments(&[]));
        assert!(place.text("out/simulation/S13.csv").contains("Q_1R [kN]"));
        let (before, after) = (
            super::super::signals(&place.path("small/simulation/S13.csv")),
            place.record("out", "S13"),
        );
        assert!((channel(&after, "Q_1R")[10] - 1e3 * channel(&before, "Q_1R")[10]).abs() < 0.01);
        assert_eq!(channel(&after, "Q_1L"), channel(&before, "Q_1L"));
    }
}

/// Another command starts each call, as on another machine: the same records, which the cache of
/// one serves to the other.
#[cfg(unix)]
#[test]
fn calls_that_another_command_starts() {
    use std::os::unix::fs::PermissionsExt;

    let place = twin();
    let launcher =
        place.write("launcher", "#!/bin/sh\n[ \"$1\" = --there ] && shift && echo \"$@\" >> \"$LOG\" && TMPDIR=/nowhere exec \"$@\"\n");
    fs::set_permissions(&launcher, fs::Permissions::from_mode(0o755)).expect("executable");
    let log = place.path("log");
    let sim = place.text("sim.yaml");
    place.write("sim.yaml", &format!("{sim}environment: {{LOG: '{}'}}\n", log.display()));
    let launch = format!("{} --there", launcher.display());
    let ran = place.simulated("there", &arguments(&["--launch", &launch]));
    assert!(ran.stderr.contains("(4 calls of twin, 0 records from the cache)"), "{}", ran.stderr);
    let calls = fs::read_to_string(&log).expect("calls");
    // The record is written where all machines see it.
    let cache = place.path("cache").display().to_string();
    assert!(
        calls.lines().count() == 4
            && calls
                .lines()
                .all(|call| call.starts_with(FISHPLATE) && call.contains(&format!("-o {cache}/")))
    );
    let ran = place.simulated("here", &arguments(&[]));
    assert!(ran.stderr.contains("(0 calls of twin, 4 records from the cache)"), "{}", ran.stderr);
    place.simulated("alone", &[&USED[..], &["--no-cache"]].concat());
    for section in SECTIONS {
        let record = format!("simulation/{section}.csv");
        assert!(place.text(&format!("there/{record}")) == place.text(&format!("alone/{record}")));
    }
    let left: Vec<_> = fs::read_dir(place.path("cache"))
        .expect("a folder")
        .flatten()
        .filter(|entry| entry.file_name().len() > 2)
        .collect();
    assert!(left.is_empty(), "{left:?}");
    let refused = place.simulate("refused", &[&USED[..], &["--launch", &launch]].concat());
    assert!(refused.code == 2 && refused.stderr.contains("--cache"), "{}", refused.stderr);
    let missing = place.simulate(
        "missing",
        &[&USED[..], &["--cache", "other", "--launch", "no-such-launcher"]].concat(),
    );
    assert!(
        missing.code == 3 && missing.stderr.contains("could not be started"),
        "{}",
        missing.stderr
    );
}

/// The process of a function is started so, too.
#[cfg(unix)]
#[test]
fn a_function_that_another_command_starts() {
    let place = Place::new();
    place.write("sim.yaml", "simulator: twin\npython: twin.py\nchannels: [Y_1R]\n");
    let body = "x = [float(one) for one in inputs['distance']]\n    time = [0.02 * one for one in x]\n    ";
    let made = "return {'time [s]': time, 'distance [m]': x, 'Y_1R [kN]': [float(os.environ['THERE'])] * len(x)}\n";
    place.write(
        "twin.py",
        &format!(
            "import os\nPARAMETERS = []\n\ndef simulate(parameters, inputs):\n    {body}{made}"
        ),
    );
    let ran = place.simulated(
        "there",
        &["--simulator", "sim.yaml", "--cache", "cache", "--launch", "env THERE=7.5"],
    );
    assert!(ran.stderr.contains("(4 calls of twin, 0 records from the cache)"), "{}", ran.stderr);
    assert!(
        channel(&place.record("there", SECTIONS[0]), "Y_1R")
            .iter()
            .all(|value| (value - 7.5).abs() < 1e-9)
    );
}
