//! Replaces `typst` in a build without the feature `typeset`: the same functions, which return an
//! error.

use crate::problem::{Problem, Problems};
use crate::report::pdf::{Attachment, Pdf};
use crate::report::study::Document;
use crate::report::view::ReportData;

/// Refuses: this build has no typesetter.
///
/// # Errors
///
/// `no-typesetter`, always.
pub fn typeset(
    _: &ReportData,
    _: &[(String, String)],
    _: &[Attachment<'_>],
) -> Result<Pdf, Problems> {
    Err(refusal())
}

/// Not available, as [`typeset`].
///
/// # Errors
///
/// `no-typesetter`, always.
pub fn typeset_study(
    _: &Document,
    _: &[(String, String)],
    _: &[Attachment<'_>],
) -> Result<Pdf, Problems> {
    Err(refusal())
}

fn refusal() -> Problems {
    let says = "this program was built without the typesetter and cannot write a PDF";
    let help = "build it with the feature `typeset`, or use `--only html` or `--only results`";
    Problems(vec![Problem::error("no-typesetter", says).help(help)])
}
