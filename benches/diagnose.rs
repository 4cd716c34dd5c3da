//! How long a diagnosis takes: `cargo bench --bench diagnose [-- CAMPAIGN...]`, by default a coach
//! and a freight wagon of sixteen sections each from the generator of campaigns with withheld
//! truths.
//!
//! By the clock, the whole command with both reports, on as many cores as there are; beside it what
//! the runs of the model take alone.

#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap
)]

#[path = "../examples/blind_campaigns/cases.rs"]
mod cases;
#[path = "../examples/blind_campaigns/hidden.rs"]
mod hidden;
#[path = "../examples/blind_campaigns/line.rs"]
mod line;
#[path = "../examples/blind_campaigns/truth.rs"]
mod truth;
#[path = "../examples/blind_campaigns/vehicles.rs"]
mod vehicles;
#[path = "../examples/blind_campaigns/write.rs"]
mod write;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use cases::SETS;

fn seconds(arguments: &[&str]) -> f64 {
    let start = Instant::now();
    let ran = Command::new(env!("CARGO_BIN_EXE_fishplate")).args(arguments).output().unwrap();
    assert!(
        ran.status.code().is_some_and(|code| code <= 1),
        "{}",
        String::from_utf8_lossy(&ran.stderr)
    );
    start.elapsed().as_secs_f64()
}

fn main() {
    let scratch = tempfile::tempdir().unwrap();
    let mut campaigns: Vec<PathBuf> =
        std::env::args().skip(1).filter(|one| !one.starts_with("--")).map(PathBuf::from).collect();
    if campaigns.is_empty() {
        let set = SETS.iter().find(|set| set.name == "derive").unwrap();
        let seed = set.seed.unwrap();
        for case in (set.cases)(seed).iter().take(2) {
            write::campaign(scratch.path(), (set, seed), case).unwrap();
            campaigns.push(scratch.path().join(format!("derive-{:02}", case.number)));
        }
    }
    for campaign in campaigns {
        time(&campaign, scratch.path());
    }
}

fn time(campaign: &Path, scratch: &Path) {
    let (campaign, out, made) =
        (campaign.to_str().unwrap(), scratch.join("out"), scratch.join("made"));
    let whole = seconds(&["diagnose", campaign, "--out", out.to_str().unwrap(), "--quiet"]);
    let once = seconds(&["simulate", campaign, "--out", made.to_str().unwrap(), "--quiet"]);
    let text = std::fs::read_to_string(out.join("diagnosis.json")).unwrap();
    let found: serde_json::Value = serde_json::from_str(&text).unwrap();
    let (runs, sections) =
        (found["simulations_run"].as_f64().unwrap(), found["how"]["sections"].as_f64().unwrap());
    println!(
        "{campaign}: {whole:.1} s for {sections} sections, {runs} runs of the model; one simulation of the campaign with its files: \
         {once:.2} s, so that {:.0} of them would have taken {:.1} s",
        runs / sections,
        once * runs / sections
    );
}
