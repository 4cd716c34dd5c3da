//! Campaigns with withheld truths, to test the diagnosis: `cargo run --release --example
//! blind_campaigns -- score --out target/campaigns`, then `fishplate blind target/campaigns`.
//!
//! The truth differs from the delivered simulation in the creep law, the profile, the integration
//! step and all parameters with a tolerance. It contains hidden effects: one, two, none, or a cause
//! outside the catalogue.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss
)]

mod cases;
mod hidden;
mod line;
mod truth;
mod vehicles;
mod write;

use std::path::PathBuf;

use cases::{Case, SETS};
use rayon::prelude::*;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let after = |key: &str| {
        arguments.iter().position(|one| one == key).and_then(|at| arguments.get(at + 1))
    };
    let number = |key: &str| after(key).and_then(|number| number.parse::<u64>().ok());
    let set = arguments.first().and_then(|name| SETS.iter().find(|set| set.name == name));
    let seed = number("--seed").or(set.and_then(|set| set.seed));
    let (Some(set), Some(seed), Some(out)) = (set, seed, after("--out")) else {
        let names: Vec<&str> = SETS.iter().map(|set| set.name).collect();
        eprintln!(
            "arguments: SET --out FOLDER [--seed N] [--only N], with SET one of {}; `fresh` needs a \
             seed",
            names.join(", ")
        );
        std::process::exit(2);
    };
    let only = number("--only").map(|number| number as usize);
    let cases: Vec<Case> = (set.cases)(seed)
        .into_iter()
        .filter(|case| only.is_none_or(|number| case.number == number))
        .collect();
    let failed: Vec<String> = cases
        .par_iter()
        .filter_map(|case| write::campaign(&PathBuf::from(out), (set, seed), case).err())
        .collect();
    failed.iter().for_each(|why| eprintln!("{why}"));
    println!("{} campaigns in {out}", cases.len() - failed.len());
    if !failed.is_empty() {
        std::process::exit(3);
    }
}
