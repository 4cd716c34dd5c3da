//! Checks of the files of a report as they are, byte by byte, and of the records of its campaign.

use std::path::PathBuf;

use super::{
    carried::{Carried, REPORT, REPORT_HTML, REPORT_PDF},
    check::Check,
    pdf::{Written, written},
};
use crate::data::{
    Campaign, RecordKind, campaign::Changed, fingerprint::fingerprint, origin::OriginFile,
    text::read_bytes,
};
use crate::problem::Problems;
use crate::result::{Certification, THIS};
use crate::run::Progress;

/// Makes the files of a report, the PDF and the HTML page if they are wanted.
pub type Make<'a> = &'a dyn Fn(&Certification, [bool; 2]) -> Result<Files, Problems>;

/// Settings for the repeated evaluation.
#[allow(missing_debug_implementations, reason = "a function has none")]
#[derive(Clone, Copy)]
pub struct Again<'a> {
    /// The campaign of the report, or all of its pool in any order.
    pub campaigns: &'a [PathBuf],
    /// Number of distance plots of the report.
    pub plots: usize,
    /// Makes the report again.
    pub make: Make<'a>,
    pub progress: Progress<'a>,
}

/// Paths inside the output folder, and contents.
pub type Files = Vec<(String, Vec<u8>)>;

/// Checks that nothing but a signature follows the end of a PDF as it was written.
pub fn end(pdf: &[u8]) -> Check {
    const NAME: &str = "end of the PDF";
    match written(pdf) {
        Ok(Written { signed: false, .. }) => {
            Check::agrees(NAME, "nothing was added after the PDF was written")
        }
        Ok(_) => Check::agrees(
            NAME,
            "nothing but a signature was added after the PDF was written; a PDF reader says whose it is",
        ),
        Err(says) => Check::differs(NAME, "the PDF was changed after it was written", vec![says]),
    }
}

/// Makes the files of the report again and compares them byte by byte, which is exact for the same
/// input: of a PDF alone its pages, of a folder every file.
pub fn pages(
    carried: &Carried,
    found: &Certification,
    again: Again<'_>,
    same: bool,
) -> Option<Check> {
    const NAME: &str = "pages";
    let Carried { pdf, folder, results, .. } = carried;
    if pdf.is_none() && folder.is_none() {
        return None;
    }
    if results.fishplate != THIS {
        let says = format!("written by fishplate {}, this is {THIS}", results.fishplate);
        return Some(Check::not_checked(NAME, says));
    }
    if !same {
        return Some(Check::not_checked(NAME, "inputs or numbers differ already"));
    }
    let there = |name: &str| match (pdf, folder) {
        (Some(pdf), _) if name == REPORT_PDF => Some(match written(pdf) {
            // What is added may begin with a line break.
            Ok(Written { end, signed: true }) => pdf[..end].trim_ascii_end().to_vec(),
            _ => pdf.clone(),
        }),
        (_, Some(folder)) => read_bytes(&folder.join(name), name, REPORT).ok(),
        (_, None) => None,
    };
    let made = match (again.make)(found, [pdf.is_some(), there(REPORT_HTML).is_some()]) {
        Ok(made) => made,
        Err(problems) => {
            let says = problems.0.first().map(|problem| problem.says.clone());
            return Some(Check::not_possible(NAME, says.unwrap_or_default()));
        }
    };
    let of_report = |(name, _): &&(String, Vec<u8>)| folder.is_some() || name == REPORT_PDF;
    let differs = |(name, made): &(String, Vec<u8>)| {
        let Some(there) = there(name) else { return Some(format!("{name}: missing")) };
        let equal = made.iter().zip(&there).take_while(|(a, b)| a == b).count();
        (*made != there).then(|| format!("{name}: from byte {} on", equal + 1))
    };
    let mut details: Vec<String> = made.iter().filter(of_report).filter_map(differs).collect();
    if !details.is_empty() {
        details.push(format!(
            "if the report has a number of plots other than {}, give it with `--plots`",
            again.plots
        ));
    }
    let agrees = match folder {
        None => "the PDF is, byte for byte, the one the program writes".to_string(),
        Some(_) => format!("{} files are, byte for byte, those the program writes", made.len()),
    };
    let differs = "files differ from those the program writes from these inputs";
    Some(Check::of(NAME, agrees, differs, details))
}

/// Checks that the records of a campaign are those that an import wrote, but those of which the
/// campaign says why they were edited. `None` if none was imported.
pub fn as_imported(campaign: &Campaign) -> Option<Check> {
    const NAME: &str = "import";
    let origin = campaign.origin.as_ref()?;
    origin.imported.as_ref()?;
    let (mut details, mut all, mut edited) = (Vec::new(), 0, 0);
    for kind in RecordKind::ALL {
        for OriginFile { path, .. } in origin.imported_records(kind.key()) {
            all += 1;
            match fingerprint(campaign.folder(), path) {
                Ok(Some((hash, _))) => match campaign.changed(kind, path, &hash) {
                    Some(Changed { reason: None, .. }) => details.push(format!("changed: {path}")),
                    Some(_) => edited += 1,
                    None => {}
                },
                Ok(None) => details.push(format!("missing: {path}")),
                Err(problem) => details.push(format!("not readable: {path}: {}", problem.says)),
            }
        }
    }
    if all == 0 {
        return Some(Check::not_asked(NAME, "origin.yaml has no hashes of the records"));
    }
    let agrees = match edited {
        0 => format!("{all} records are those that the import wrote"),
        edited => format!("{all} records, {edited} of them edited, as campaign.yaml says"),
    };
    Some(Check::of(NAME, agrees, "records are not those that the import wrote", details))
}
