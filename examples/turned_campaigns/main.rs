//! Campaigns from real measurements with known deficiencies of the model, to which a further
//! deviation is added, to test the diagnosis on records of another program or of a test: `cargo run
//! --release --example turned_campaigns -- CAMPAIGN... --seed 7 --out target/turned`, then
//! `fishplate blind target/turned`.
//!
//! The effects of a campaign's `truth.json` are included in the vehicle file or removed from the
//! records; without that file, the model is taken as correct. Then an effect is hidden: a parameter
//! of the vehicle file is changed, an operation is applied to the records, or the change by an
//! effect is added to them with the reference model. The simulation is repeated.

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
    let bases = folders
        .into_iter()
        .map(|folder| Base::open(Path::new(folder), &catalogue))
        .collect::<Result<Vec<_>, _>>()?;
    let cases = cases::drawn(&bases, &catalogue, seed);
    let out = Path::new(out);
    let turn = |(at, case): (usize, &cases::Case)| {
        let name = format!("turned-{:02}", at + 1);
        turn::campaign(&out.join(&name), &bases[case.base], case, &catalogue)
            .map_err(|why| format!("{name}: {why}"))
    };
    let failed: Vec<String> =
        cases.par_iter().enumerate().filter_map(|case| turn(case).err()).collect();
    if failed.is_empty() {
        Ok(format!("{} campaigns in {}", cases.len(), out.display()))
    } else {
        Err(failed.join("\n"))
    }
}
