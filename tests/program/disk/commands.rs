//! Whole runs of the program, each with one fault at every operation, or at operations evenly
//! between where a run is long.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use fishplate::cli::{Exit, run_with};
use fishplate::disk::faults::Op;
use tempfile::TempDir;

use crate::disk::injector::{INJECTED, MODES, Mode, files, with_fault};
use crate::disk::{alone, campaign};

type Files = BTreeMap<String, Vec<u8>>;

/// A run, and the one whose outputs it finds.
#[derive(Clone, Copy, Debug)]
struct Case<'a> {
    /// `IN` stands for the folder of inputs, `OUT` for that of outputs.
    before: &'a [&'a str],
    now: &'a [&'a str],
    /// Most points that are tried of each mode among reads, and among all else.
    most: usize,
    /// Builds the inputs.
    inputs: fn(&Path),
    /// Whether outputs are one set, or files that are each whole.
    set: bool,
}

fn call(words: &[&str], place: &Path) -> Exit {
    let word = |word: &&str| {
        let inside = |name: &str| place.join(name).display().to_string();
        OsString::from(word.replace("IN", &inside("in")).replace("OUT", &inside("out")))
    };
    run_with(std::iter::once(OsString::from("fishplate")).chain(words.iter().map(word)))
}

/// The inputs, and what a run before left.
fn first(case: &Case<'_>) -> TempDir {
    let temp = tempfile::tempdir().expect("a temporary folder");
    fs::create_dir(temp.path().join("in")).expect("made");
    (case.inputs)(&temp.path().join("in"));
    fs::create_dir_all(temp.path().join("out")).expect("made");
    if !case.before.is_empty() {
        let exit = call(case.before, temp.path());
        assert!(matches!(exit, Exit::Done | Exit::DoesNotHold), "{exit:?}");
    }
    fs::write(temp.path().join("out/mine.txt"), "mine").expect("written");
    temp
}

fn outputs(place: &Path) -> Files {
    files(&place.join("out"))
}

/// Reads are many and alike; what changes the disk is tried first.
fn points(ops: &[Op], most: usize) -> Vec<usize> {
    let reads = [Op::Look, Op::List, Op::Open, Op::Read, Op::Reserve];
    let (reading, changing): (Vec<usize>, Vec<usize>) =
        (1..=ops.len()).partition(|at| reads.contains(&ops[at - 1]));
    let spread = |all: &[usize]| -> Vec<usize> {
        let count = all.len().min(most);
        (0..count).map(|nth| all[nth * all.len() / count]).collect()
    };
    let mut all = [spread(&reading), spread(&changing)].concat();
    all.sort_unstable();
    all
}

fn every_point(name: &str, case: &Case<'_>) {
    let first = first(case);
    let place = || campaign::copy(first.path());
    let (inputs, old) = (files(&first.path().join("in")), outputs(first.path()));
    let temp = place();
    let run = with_fault(0, Mode::Once, || call(case.now, temp.path()));
    assert!(matches!(run.gave, Exit::Done | Exit::DoesNotHold), "{name}: {:?}", run.gave);
    let new = outputs(temp.path());
    assert!(new != old && new.contains_key("mine.txt"), "{name}");
    let mut tried = 0;
    for mode in MODES {
        for at in points(&run.ops, case.most) {
            let temp = place();
            let run = with_fault(at, mode, || call(case.now, temp.path()));
            tried += usize::from(run.hit);
            let found = outputs(temp.path());
            let what = format!(
                "{name}, {mode:?} at {at}, {}: {:?}, {:?}",
                run.what,
                run.gave,
                found.keys()
            );
            if case.set {
                left(mode, run.gave, &found, &old, &new, temp.path(), &what);
            } else {
                // That the name of the last file may not be on the disk yet is told, too.
                for (file, bytes) in &found {
                    assert!(
                        old.get(file) == Some(bytes) || new.get(file) == Some(bytes),
                        "{file} of {what}"
                    );
                }
                let ended = matches!(run.gave, Exit::Wrong | Exit::Unfinished);
                assert!(ended || found == new || mode == Mode::Killed, "{what}");
            }
            // Inputs that are not written stay as they are in any case.
            if case.set {
                assert_eq!(files(&temp.path().join("in")), inputs, "{what}");
            }
            // Nothing hinders the next run, where something was changed by this one.
            if run.ops.contains(&Op::Create) {
                call(case.now, temp.path());
                assert!(outputs(temp.path()) == new, "after {what}");
            }
        }
    }
    eprintln!("{tried} points of {name}, of {} operations", run.ops.len());
}

/// Each folder holds a set of its own; one of two may be the new one already when the other fails,
/// which is told.
fn left(mode: Mode, exit: Exit, found: &Files, old: &Files, new: &Files, place: &Path, what: &str) {
    const OF_TWO: [&str; 2] = ["improved/", "report/"];
    let failed = matches!(exit, Exit::Wrong | Exit::Unfinished);
    // The fault of one record is told in the result, as the reason why its section is not used.
    if told(found) {
        return;
    }
    if mode != Mode::Killed && !failed {
        return assert!(found == new, "{what}");
    }
    for folder in [""].iter().chain(&OF_TWO) {
        let part = |files: &Files| -> Files {
            let inside = |name: &String| {
                if folder.is_empty() {
                    !OF_TWO.iter().any(|of| name.starts_with(of))
                } else {
                    name.starts_with(folder)
                }
            };
            files
                .iter()
                .filter(|(name, _)| inside(name))
                .map(|(name, bytes)| (name.clone(), bytes.clone()))
                .collect()
        };
        let (found, old, new) = (part(found), part(old), part(new));
        let within = |set: &Files| found.iter().all(|(name, bytes)| set.get(name) == Some(bytes));
        let unfinished = mode == Mode::Killed
            && place.join("out").join(folder).join(".fishplate-unfinished").is_dir();
        // What failed is the first of two, or there is but one: then nothing is new.
        let new_of_two = found == new && (mode == Mode::Killed || *folder == "report/");
        assert!(
            found == old || new_of_two || unfinished && (within(&old) || within(&new)),
            "`{folder}` of {what}"
        );
    }
}

fn told(found: &Files) -> bool {
    let says = |name: &str| {
        found.get(name).is_some_and(|bytes| String::from_utf8_lossy(bytes).contains(INJECTED))
    };
    says("results.json")
        || says("study.json")
        || says("diagnosis.json")
        || says("report/diagnosis.json")
}

/// One section in each of the zones 1 and 4.
fn small(folder: &Path) {
    campaign::write_tiny(folder);
    let path = folder.join("sections.csv");
    campaign::lines(&path, |lines| {
        lines.retain(|line| ["section", "S01", "S10"].iter().any(|name| line.starts_with(name)))
    });
    for path in crate::disk::program::files(folder)
        .iter()
        .filter(|path| path.extension().is_some_and(|extension| extension == "csv"))
    {
        if path
            .file_stem()
            .is_some_and(|stem| !["sections", "S01", "S10"].iter().any(|name| *stem == **name))
        {
            fs::remove_file(path).expect("removed");
        }
    }
}

/// One section of the example, short enough to be simulated often.
fn with_model(folder: &Path) {
    let coach = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("examples/coach");
    for kind in ["measurement", "simulation", "track"] {
        fs::create_dir(folder.join(kind)).expect("made");
        fs::copy(coach.join(kind).join("S13.csv"), folder.join(kind).join("S13.csv"))
            .expect("copied");
    }
    for file in ["campaign.yaml", "vehicle.yaml", "profile.csv", "profile_worn.csv", "sections.csv"]
    {
        fs::copy(coach.join(file), folder.join(file)).expect("copied");
    }
    campaign::lines(&folder.join("sections.csv"), |lines| {
        lines.retain(|line| line.starts_with("section") || line.starts_with("S13"))
    });
}

fn protocols(folder: &Path) {
    let text = fishplate::library::shipped("sprague-geers").expect("shipped").text.clone();
    fs::write(folder.join("a.fp"), text.replace("  ", "    ")).expect("written");
}

fn two_protocols_in_out(folder: &Path) {
    protocols(folder);
    let text = fs::read(folder.join("a.fp")).expect("there");
    let out = folder.parent().expect("a place").join("out");
    fs::create_dir_all(&out).expect("made");
    fs::write(out.join("a.fp"), &text).expect("written");
    fs::write(out.join("b.fp"), &text).expect("written");
}

#[test]
fn certify() {
    if alone("commands::certify") {
        let before = [
            "certify",
            "IN",
            "-q",
            "-j",
            "1",
            "--out",
            "OUT",
            "--only",
            "html",
            "--set",
            "lowpass_frequency=15 Hz",
        ];
        let now = ["certify", "IN", "-q", "-j", "1", "--out", "OUT", "--only", "results"];
        every_point(
            "certify",
            &Case { before: &before, now: &now, most: usize::MAX, inputs: small, set: true },
        );
    }
}

#[test]
fn certify_with_the_report() {
    if alone("commands::certify_with_the_report") {
        let before = [
            "certify",
            "IN",
            "-q",
            "-j",
            "1",
            "--out",
            "OUT",
            "--only",
            "html",
            "--set",
            "lowpass_frequency=15 Hz",
        ];
        let now = ["certify", "IN", "-q", "-j", "1", "--out", "OUT"];
        every_point(
            "certify with the report",
            &Case { before: &before, now: &now, most: 5, inputs: small, set: true },
        );
    }
}

#[test]
fn study() {
    if alone("commands::study") {
        let before = ["certify", "IN", "-q", "-j", "1", "--out", "OUT", "--only", "results"];
        let now = ["study", "sections", "IN", "-q", "-j", "1", "--out", "OUT"];
        every_point(
            "study",
            &Case { before: &before, now: &now, most: 12, inputs: campaign::write_tiny, set: true },
        );
    }
}

#[test]
fn simulate() {
    if alone("commands::simulate") {
        let before = ["simulate", "IN", "-q", "-j", "1", "--out", "OUT"];
        let now = ["simulate", "IN", "-q", "-j", "1", "--out", "OUT", "--effect", "friction=0.5"];
        every_point(
            "simulate",
            &Case { before: &before, now: &now, most: 12, inputs: with_model, set: true },
        );
    }
}

#[test]
fn diagnose_and_write_what_it_improved() {
    if alone("commands::diagnose_and_write_what_it_improved") {
        let now = [
            "diagnose",
            "IN",
            "-q",
            "-j",
            "1",
            "--out",
            "OUT/report",
            "--write-improved",
            "OUT/improved",
        ];
        every_point(
            "diagnose",
            &Case { before: &[], now: &now, most: 6, inputs: small, set: true },
        );
    }
}

#[test]
fn manual_pages() {
    if alone("commands::manual_pages") {
        every_point(
            "man",
            &Case {
                before: &[],
                now: &["man", "--out", "OUT"],
                most: usize::MAX,
                inputs: protocols,
                set: true,
            },
        );
    }
}

#[test]
fn single_files() {
    if alone("commands::single_files") {
        let convert = ["convert", "IN/a.fp", "--to", "yaml", "-o", "OUT/x"];
        let explain = ["explain", "IN/a.fp", "--stage", "graph", "--format", "svg", "-o", "OUT/x"];
        let case = Case {
            before: &convert,
            now: &explain,
            most: usize::MAX,
            inputs: protocols,
            set: false,
        };
        every_point("explain -o", &case);
        every_point("convert -o", &Case { before: &explain, now: &convert, ..case });
    }
}

#[test]
fn formatting_of_two_files() {
    if alone("commands::formatting_of_two_files") {
        let now = ["fmt", "OUT/a.fp", "OUT/b.fp"];
        every_point(
            "fmt",
            &Case {
                before: &[],
                now: &now,
                most: usize::MAX,
                inputs: two_protocols_in_out,
                set: false,
            },
        );
    }
}

/// Work that grows with the square of the sections would be seen in the folders that are listed.
#[test]
fn sections_without_records_are_linear() {
    if alone("commands::sections_without_records_are_linear") {
        let temp = tempfile::tempdir().expect("a temporary folder");
        fs::create_dir(temp.path().join("in")).expect("made");
        campaign::write_tiny(&temp.path().join("in"));
        campaign::lines(&temp.path().join("in/sections.csv"), |lines| {
            let row = lines[1].clone();
            lines.extend((0..2000).map(|nth| row.replacen("S01", &format!("X{nth}"), 1)));
        });
        let words = ["certify", "IN", "-q", "-j", "1", "--out", "OUT", "--only", "results"];
        let run = with_fault(0, Mode::Once, || call(&words, temp.path()));
        let listed = run.ops.iter().filter(|op| **op == Op::List).count();
        assert!(
            listed < 10,
            "{:?}: {listed} lists of names, {} operations",
            run.gave,
            run.ops.len()
        );
        assert!(run.ops.len() < 100 * 2000, "{}", run.ops.len());
    }
}
