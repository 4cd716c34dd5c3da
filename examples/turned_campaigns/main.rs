//! Campaigns turned round: measurements of which is known what the model lacks, with something else taken from the model or done to the
//! records, to test the diagnosis on records that another code or a test made:
//! `cargo run --release --example turned_campaigns -- CAMPAIGN... --seed 7 --out target/turned`, then `fishplate blind target/turned`.
//!
//! What `truth.json` of a campaign says is put into the vehicle file or taken off the records, so that nothing is missing; without that
//! file nothing is taken to be missing. Then something is hidden: a parameter of the vehicle file is moved away from what was measured,
//! the records go through an operation, or our own model adds to them what an effect changes. The simulation is made anew.

#![allow(clippy::print_stdout, clippy::print_stderr, clippy::cast_precision_loss)]

mod base;
mod cases;
mod draw;
mod faults;
#[path = "../blind_campaigns/hidden.rs"]
mod hidden;
mod turn;

use std::path::Path;

use rayon::prelude::*;

use base::Base;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(says) => println!("{says}"),
        Err(why) => {
            eprintln!("{why}");
            std::process::exit(3);
        }
    }
}

fn run(arguments: &[String]) -> Result<String, String> {
    let mut folders = Vec::new();
    let (mut seed, mut out) = (None, None);
    let mut words = arguments.iter();
    while let Some(word) = words.next() {
        match word.as_str() {
            "--seed" => seed = words.next().and_then(|seed| seed.parse().ok()),
            "--out" => out = words.next(),
            folder => folders.push(folder),
        }
    }
    let (Some(seed), Some(out), false) = (seed, out, folders.is_empty()) else {
        return Err("arguments: CAMPAIGN... --seed NUMBER --out FOLDER".to_string());
    };
    let catalogue = hidden::catalogue()?;
    let bases = folders.into_iter().map(|folder| Base::open(Path::new(folder), &catalogue)).collect::<Result<Vec<_>, _>>()?;
    let cases = cases::drawn(&bases, &catalogue, seed);
    let out = Path::new(out);
    let turn = |(at, case): (usize, &cases::Case)| {
        let name = format!("turned-{:02}", at + 1);
        turn::campaign(&out.join(&name), &bases[case.base], case, &catalogue).map_err(|why| format!("{name}: {why}"))
    };
    let failed: Vec<String> = cases.par_iter().enumerate().filter_map(|case| turn(case).err()).collect();
    if failed.is_empty() { Ok(format!("{} campaigns in {}", cases.len(), out.display())) } else { Err(failed.join("\n")) }
}
