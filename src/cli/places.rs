//! Where a run may write: not over what it reads.

use std::path::{Path, PathBuf};

use crate::data::{Campaign, campaign::Inputs};
use crate::disk;
use crate::problem::Problem;

/// Names at the top of the folder of a report.
pub const REPORT: &[&str] =
    &["results.json", "study.json", "diagnosis.json", "blind.json", "blind.html", "report.pdf", "report.html", "tables"];
/// Names at the top of the folder of a campaign that is written: it is copied with all it names, so that any folder of a campaign will do.
pub const CAMPAIGN: &[&str] = &["campaign.yaml", "simulation"];

/// Refuses a folder for outputs that would overwrite what a campaign is read from; `names` is what is written at its top.
///
/// # Errors
/// `output-is-input`, before anything is computed.
pub fn check_folder(out: &Path, names: &[&str], campaign: &Campaign) -> Result<(), Problem> {
    let refused = |why: String| {
        Problem::error("output-is-input", format!("the outputs cannot go to `{}`: {why}", out.display()))
            .help("give another folder; it is made if it does not exist")
    };
    let Inputs { folder, folders, files } = campaign.inputs();
    let real = real(out).map_err(|error| refused(format!("it cannot be looked at: {error}")))?;
    if folders.iter().any(|records| real.starts_with(records) && *records != folder) {
        return Err(refused("the records of the campaign lie there".to_string()));
    }
    for name in names {
        let written = real.join(name);
        let hit = files.iter().chain(&folders).find(|input| input.starts_with(&written));
        if let Some(hit) = hit {
            let hit = hit.strip_prefix(&real).unwrap_or(hit);
            return Err(refused(format!("`{}` would be overwritten, which the campaign is read from", hit.display())));
        }
    }
    Ok(())
}

/// Refuses a file for output that is one of the inputs.
///
/// # Errors
/// `output-is-input`.
pub fn check_file(out: &Path, inputs: &[&Path]) -> Result<(), Problem> {
    match inputs.iter().find(|input| same(out, input)) {
        Some(_) => Err(Problem::error("output-is-input", format!("`{}` is read, and cannot be written", out.display()))),
        None => Ok(()),
    }
}

/// Whether two paths lead to the same place.
pub fn same(one: &Path, other: &Path) -> bool {
    real(one).is_ok_and(|one| real(other).is_ok_and(|other| one == other))
}

/// A path without symbolic links, of which the last parts need not exist.
fn real(path: &Path) -> std::io::Result<PathBuf> {
    let absolute = std::path::absolute(path)?;
    for above in absolute.ancestors() {
        if let Some(real) = disk::real(above)? {
            let rest = absolute.strip_prefix(above).unwrap_or(Path::new(""));
            return Ok(if rest.as_os_str().is_empty() { real } else { real.join(rest) });
        }
    }
    Ok(absolute)
}
