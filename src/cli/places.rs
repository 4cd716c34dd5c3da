//! Checks that outputs do not overwrite inputs.

use std::path::{Path, PathBuf};

use crate::data::{Campaign, campaign::Inputs};
use crate::disk;
use crate::problem::Problem;

/// Names at the top level of a report folder.
pub const REPORT: &[&str] = &[
    "results.json",
    "study.json",
    "diagnosis.json",
    "exercise.json",
    "impact.json",
    "blind.json",
    "blind.html",
    "report.pdf",
    "report.html",
    "tables",
];
/// Names at the top level of a written campaign, which is copied with all files it names.
pub const CAMPAIGN: &[&str] = &["campaign.yaml", "simulation"];

/// Refuses an output folder that is a file, or in one.
///
/// # Errors
/// `not-a-folder`, before the computation.
pub fn check_out(out: &Path) -> Result<(), Problem> {
    let file = out.ancestors().find(|above| {
        matches!(disk::kind(above), Ok(Some(disk::Kind::File(_) | disk::Kind::Other)))
    });
    let Some(file) = file else { return Ok(()) };
    let says =
        format!("the outputs cannot go to `{}`: `{}` is a file", out.display(), file.display());
    Err(Problem::error("not-a-folder", says)
        .help("give another folder; it is created if it does not exist"))
}

/// Refuses an output folder if files of the campaign would be overwritten; `names` are the outputs
/// at its top level.
///
/// # Errors
/// `output-is-input`, `not-a-folder`, before the computation.
pub fn check_folder(out: &Path, names: &[&str], campaign: &Campaign) -> Result<(), Problem> {
    check_out(out)?;
    let refused = |why: String| {
        Problem::error(
            "output-is-input",
            format!("the outputs cannot go to `{}`: {why}", out.display()),
        )
        .help("give another folder; it is created if it does not exist")
    };
    let Inputs { folder, folders, files } = campaign.inputs();
    let real = real(out).map_err(|error| refused(format!("it cannot be read: {error}")))?;
    if folders.iter().any(|records| real.starts_with(records) && *records != folder) {
        return Err(refused("it contains the records of the campaign".to_string()));
    }
    for name in names {
        let written = real.join(name);
        let hit = files.iter().chain(&folders).find(|input| input.starts_with(&written));
        if let Some(hit) = hit {
            let hit = hit.strip_prefix(&real).unwrap_or(hit);
            return Err(refused(format!(
                "`{}` is a file of the campaign and would be overwritten",
                hit.display()
            )));
        }
    }
    Ok(())
}

/// Refuses an output file that is one of the inputs, or a folder.
///
/// # Errors
/// `output-is-input`, `not-a-file`, before the computation.
pub fn check_file(out: &Path, inputs: &[&Path]) -> Result<(), Problem> {
    check_not_input(out, inputs)?;
    match disk::is_folder(out) {
        Ok(true) => {
            let says = format!("`{}` is a folder, and the output is a file", out.display());
            Err(Problem::error("not-a-file", says).help("name a file in it"))
        }
        _ => Ok(()),
    }
}

/// Refuses an output that is one of the inputs.
///
/// # Errors
/// `output-is-input`.
pub fn check_not_input(out: &Path, inputs: &[&Path]) -> Result<(), Problem> {
    match inputs.iter().find(|input| same(out, input)) {
        Some(_) => Err(Problem::error(
            "output-is-input",
            format!("`{}` is an input and cannot be overwritten", out.display()),
        )),
        None => Ok(()),
    }
}

/// Whether two paths are the same place.
pub fn same(one: &Path, other: &Path) -> bool {
    real(one).is_ok_and(|one| real(other).is_ok_and(|other| one == other))
}

/// A path without symbolic links; its last parts need not exist.
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
