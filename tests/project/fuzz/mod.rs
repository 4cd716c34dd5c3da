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

/// Inputs of each target that are made from its seeds; the slower a target, the fewer.
const CHANGED: usize = 200;

/// A short fuzzing, the same at every run: parts of seeds are cut out, doubled, exchanged with
/// those of other seeds, or written over. `fuzz/run` is the long one, which follows the edges of
/// the program.
#[test]
fn changed_seeds_keep_the_promises() {
    let seeds = targets::seeds::seeds(root());
    for (target, _) in targets::TARGETS {
        let own: Vec<&[u8]> = seeds
            .iter()
            .filter(|(name, input)| *name == target && input.len() <= LONGEST)
            .map(|(_, input)| input.as_slice())
            .collect();
        let tries = if SLOW.contains(&target) { CHANGED / 10 } else { CHANGED };
        let mut random = fastrand::Rng::with_seed(1);
        for number in 0..tries {
            let input = changed(&own, &mut random);
            let ran = std::panic::catch_unwind(|| targets::run(target, &input));
            assert!(ran.is_ok(), "{target}, input {number}: {}", input.escape_ascii());
        }
    }
}

/// Targets that take a hundredth of a second or more for an input.
const SLOW: [&str; 7] =
    ["protocol_text", "protocol_yaml", "check", "campaign", "vehicle", "sections", "report"];

/// Seeds that are longer are not changed [bytes]: a reader takes long for them.
const LONGEST: usize = 16_384;

fn changed(seeds: &[&[u8]], random: &mut fastrand::Rng) -> Vec<u8> {
    let Some(seed) = random.choice(seeds) else { return Vec::new() };
    let mut input = seed.to_vec();
    for _ in 0..random.usize(1..=4) {
        let at = random.usize(..=input.len());
        let end = (at + random.usize(..=16)).min(input.len());
        match random.u8(..5) {
            0 => drop(input.drain(at..end)),
            1 => drop(input.splice(at..at, input[at..end].to_vec())),
            2 => {
                let other: &[u8] = random.choice(seeds).map_or(&[], |other| other);
                let from = random.usize(..=other.len());
                let to = (from + random.usize(..=32)).min(other.len());
                drop(input.splice(at..end, other[from..to].iter().copied()));
            }
            3 => input[at..end].iter_mut().for_each(|byte| *byte = random.u8(..)),
            _ => input.truncate(if random.u8(..8) == 0 { at } else { input.len() }),
        }
    }
    input
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
