//! The promises that the fuzzer tries (`fuzz/src`), with its seeds and with every input that once
//! broke one: `tests/cases/fuzz/TARGET/*`.

use std::fs;
use std::path::Path;

// The fuzzer is a package of its own; its promises are compiled into this test as they stand there.
#[path = "../../../fuzz/src/lib.rs"]
#[allow(dead_code, reason = "the fuzzer's own programs use the rest")]
mod targets;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Seeds of one target beyond this many are tried at even steps.
const MOST: usize = 60;

#[test]
fn seeds_keep_the_promises() {
    let seeds = targets::seeds::seeds(root());
    for (target, _) in targets::TARGETS {
        let own: Vec<_> = seeds.iter().filter(|(name, _)| *name == target).collect();
        assert!(!own.is_empty(), "{target} has no seed");
        own.iter()
            .step_by(own.len().div_ceil(MOST))
            .for_each(|(_, input)| targets::run(target, input));
    }
}

#[test]
fn inputs_that_once_failed_do_so_no_more() {
    let folder = root().join("tests/cases/fuzz");
    let mut tried = 0;
    for entry in fs::read_dir(&folder).expect("a folder").flatten() {
        let target = entry.file_name().to_string_lossy().into_owned();
        for input in fs::read_dir(entry.path()).expect("a target's folder").flatten() {
            eprintln!("{target}: {}", input.file_name().display());
            targets::run(&target, &fs::read(input.path()).expect("readable"));
            tried += 1;
        }
    }
    assert!(tried > 0, "no input is there");
}

/// Each target has its program, and each program its target.
#[test]
fn every_target_has_a_program() {
    let mut programs: Vec<String> = fs::read_dir(root().join("fuzz/fuzz_targets"))
        .expect("a folder")
        .flatten()
        .map(|entry| entry.path().file_stem().unwrap_or_default().to_string_lossy().into_owned())
        .collect();
    programs.sort();
    let mut targets: Vec<&str> = targets::TARGETS.iter().map(|(name, _)| *name).collect();
    targets.sort_unstable();
    assert_eq!(programs, targets);
}
