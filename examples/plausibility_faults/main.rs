//! How many faults of data are told by rules of plausibility, and what is told of sound campaigns.
//!
//! `cargo run --release --example plausibility_faults` makes five sound campaigns and two that
//! fail, draws faults of each mechanism at random, puts them in one at a time, and prints by
//! mechanism how many are told. The size of a fault is such that a statistic of the protocol moves
//! by a tenth of its limit up to the whole limit. Told is a finding, or a section or the verdict
//! removed, that names the channel, side, wheelset, section or folder concerned and that the
//! campaign without the fault does not have.
//!
//! `--seed N` draws others; `--list` prints every fault and what was told first, and what was told
//! of sound variations; `--each N` sets the number of faults of a mechanism; `--only TEXT` draws
//! kinds whose name contains it, and nothing else; `--program PATH` evaluates the same faults with
//! another program through its command line.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss
)]

#[allow(dead_code, reason = "the making of campaigns is shared with another example")]
mod bench;

use std::path::PathBuf;

use bench::answer::Found;
use bench::evaluate::Program;
use bench::{Base, Case, MECHANISMS, made, variations};

/// The seed of the faults that are drawn if none is given.
const SEED: u64 = 2026;
/// The number of faults of a mechanism.
const OF_EACH: usize = 40;

struct Arguments {
    program: Program,
    seed: u64,
    of_each: usize,
    only: Option<String>,
    list: bool,
}

fn main() {
    let done = arguments().and_then(|arguments| run(&arguments));
    if let Err(why) = done {
        eprintln!("{why}");
        std::process::exit(2);
    }
}

fn arguments() -> Result<Arguments, String> {
    let mut all =
        Arguments { program: Program::Own, seed: SEED, of_each: OF_EACH, only: None, list: false };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        if word == "--list" {
            all.list = true;
            continue;
        }
        let value = words.next().ok_or_else(|| format!("`{word}` needs a value, or is unknown"))?;
        let number = || value.parse().map_err(|_| format!("{word}: `{value}` is not a number"));
        match word.as_str() {
            "--seed" => all.seed = number()?,
            "--each" => all.of_each = number()? as usize,
            "--only" => all.only = Some(value),
            "--program" => all.program = Program::Other(PathBuf::from(value)),
            _ => return Err(format!("unknown argument `{word}`; see the head of main.rs")),
        }
    }
    Ok(all)
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let place = tempfile::tempdir().map_err(|error| error.to_string())?;
    let program = &arguments.program;
    let bases = bench::bases(program, &made::sound(), &[made::failing()], place.path())?;
    for base in &bases {
        println!("{}: {}", base.name, base.answer.verdict);
        listed_findings(&base.answer.findings);
    }
    let only = arguments.only.as_deref().unwrap_or_default();
    let show = |case: &Case| {
        if arguments.list {
            listed(case, &bases[case.base].name);
        }
    };
    let drawn = (arguments.seed, arguments.of_each);
    let cases = bench::faults(program, &bases, drawn, only, &show);
    table(&cases, &bases);
    if arguments.only.is_some() {
        return Ok(());
    }
    let first = bench::first_round(program, &bases[0]);
    let told = first.iter().filter(|(_, score)| score.told).count();
    println!("| first round, fixed | {} | {told} | | |", first.len());
    for (name, score) in first.iter().filter(|(_, score)| arguments.list && !score.told) {
        println!("NOT TOLD | first round | {name} | {} | {}", score.verdict, score.says);
    }
    let sound: Vec<String> =
        bases.iter().filter(|base| !base.fails).map(|base| base.name.clone()).collect();
    let variations = variations::all(&sound, arguments.seed);
    let quiet = bench::quiet(program, &bases, &variations, place.path())?;
    let wrongly = quiet.iter().filter(|sound| !sound.wrongly.is_empty());
    println!("\nsound variations: {}, told wrongly: {}", quiet.len(), wrongly.clone().count());
    for sound in wrongly.filter(|_| arguments.list) {
        println!("TOLD WRONGLY | {} | {}", sound.name, sound.verdict);
        sound.wrongly.iter().for_each(|says| println!("    {says}"));
    }
    Ok(())
}

fn table(cases: &[Case], bases: &[Base]) {
    let row = |name: &str, within: &dyn Fn(&Case) -> bool| {
        let within = || cases.iter().filter(|case| within(case));
        println!(
            "| {name} | {} | {} | {} | {} |",
            within().count(),
            within().filter(|case| case.score.told).count(),
            within().filter(|case| case.score.first).count(),
            within().filter(|case| bases[case.base].fails && case.score.validated()).count(),
        );
    };
    println!("\n| mechanism | faults | told | right cause first | failing campaigns validated |");
    println!("|---|---|---|---|---|");
    for (at, (mechanism, _)) in MECHANISMS.iter().enumerate() {
        row(mechanism, &|case| case.mechanism == at);
    }
    row("all", &|_| true);
}

fn listed(case: &Case, base: &str) {
    let mark = match (case.score.told, case.score.first) {
        (true, true) => "told",
        (true, false) => "ANOTHER CAUSE FIRST",
        (false, _) => "NOT TOLD",
    };
    let moved = if case.moved.is_nan() { String::new() } else { format!("{:.2}", case.moved) };
    println!(
        "{mark} | {} | {} | {base} | {} | moves {moved} | {} | {}",
        MECHANISMS[case.mechanism].0, case.kind, case.says, case.score.verdict, case.score.says
    );
}

/// What is told of a campaign before a fault is put into it.
fn listed_findings(findings: &[Found]) {
    for found in findings {
        println!("    [{}] in {} places", found.code, found.places.len());
    }
}
