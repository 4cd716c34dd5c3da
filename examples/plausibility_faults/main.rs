//! Rate of detection of faults of kinds that occur in real campaigns, and findings in correct
//! campaigns: `cargo run --release --example plausibility_faults -- SOUND... --faults-in SOUND...`
//!
//! The campaigns before `--faults-in` are only checked; each fault is applied to those after it,
//! one at a time. The example `blind_campaigns` writes such campaigns; those without a hidden
//! effect are correct.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss
)]

mod faults;
mod folder;
mod score;

use std::path::Path;

use folder::Folder;
use rayon::prelude::*;
use score::{Outcome, Score, certified};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let split = arguments.iter().position(|one| one == "--faults-in").unwrap_or(arguments.len());
    let mut quiet = 0;
    for sound in &arguments[..split] {
        let says: Vec<String> = match certified(Path::new(sound)) {
            Outcome::Done(found) => found
                .findings
                .iter()
                .map(|finding| format!("[{}] {}", finding.code, finding.first.text()))
                .collect(),
            Outcome::Refused(problems) => {
                problems.0.iter().map(|problem| format!("refused: {}", problem.says)).collect()
            }
        };
        quiet += usize::from(says.is_empty());
        says.iter().for_each(|says| println!("{sound}: {says}"));
    }
    println!("sound campaigns of which nothing is told: {quiet} of {split}");
    let (mut told, mut all) = (0, 0);
    for campaign in arguments.iter().skip(split + 1) {
        let sound = Folder::read(Path::new(campaign));
        let scores: Vec<Score> =
            faults::all().par_iter().map(|fault| score::score(&sound, fault)).collect();
        for score in &scores {
            let mark = if score.told { "told" } else { "NOT TOLD" };
            let validated = if score.validated { " VALIDATED" } else { "" };
            println!("{campaign}: {mark}{validated}: {}: {}", score.fault, score.says);
        }
        let of_it = scores.iter().filter(|score| score.told).count();
        println!("{campaign}: {of_it} of {} faults told", scores.len());
        (told, all) = (told + of_it, all + scores.len());
    }
    println!("faults told: {told} of {all}");
}
