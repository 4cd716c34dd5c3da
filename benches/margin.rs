//! Wall time of `study margin`, with declared uncertainties and without.
//!
//! ```text
//! cargo bench --bench margin [-- CAMPAIGN...]
//! ```
//!
//! Without a campaign, that of the coach. The aim is a minute for 33 sections. A campaign that
//! declares no uncertainties is timed a second time with some: a gain of 1 % of the guiding force,
//! alike at all wheels, and an offset of the wheel force of its own at each.

#![expect(clippy::print_stdout, reason = "a benchmark speaks to the terminal")]

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

type Outcome<T> = Result<T, Box<dyn Error>>;

const SCRATCH: &str = env!("CARGO_TARGET_TMPDIR");

const UNCERTAINTIES: &str =
    "uncertainty:\n  Y: {standard: 1.2 %}\n  Q: {standard: 0.7 kN, correlated: false}\n";

fn main() -> Outcome<()> {
    let mut campaigns: Vec<PathBuf> = std::env::args()
        .skip(1)
        .filter(|word| !word.starts_with("--"))
        .map(PathBuf::from)
        .collect();
    if campaigns.is_empty() {
        campaigns.push(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/coach"));
    }
    for campaign in &campaigns {
        println!("{}", campaign.display());
        println!("  {:<24} {:>7.1} s", "as declared", seconds(campaign)?);
        let text = fs::read_to_string(campaign.join("campaign.yaml"))?;
        if !text.contains("uncertainty:\n") {
            let with = declared(campaign, &text)?;
            println!("  {:<24} {:>7.1} s", "with uncertainties", seconds(&with)?);
        }
    }
    Ok(())
}

fn seconds(campaign: &Path) -> Outcome<f64> {
    let start = Instant::now();
    let done = Command::new(env!("CARGO_BIN_EXE_fishplate"))
        .args(["study", "margin", "--quiet"])
        .arg(campaign)
        .arg("--out")
        .arg(Path::new(SCRATCH).join("margin"))
        .status()?;
    if !done.success() {
        return Err(format!("the study ended with {done}").into());
    }
    Ok(start.elapsed().as_secs_f64())
}

/// A copy of the campaign that declares uncertainties, without its declared tolerances, which may
/// contradict them.
fn declared(campaign: &Path, text: &str) -> Outcome<PathBuf> {
    let to = Path::new(SCRATCH).join("margin-campaign");
    if to.exists() {
        fs::remove_dir_all(&to)?;
    }
    copy(campaign, &to)?;
    let text = text.replace("declared_tolerances:", "other_tolerances:");
    fs::write(to.join("campaign.yaml"), format!("{text}{UNCERTAINTIES}"))?;
    Ok(to)
}

fn copy(from: &Path, to: &Path) -> Outcome<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let (path, to) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() { copy(&path, &to)? } else { fs::copy(&path, &to).map(drop)? }
    }
    Ok(())
}
