//! Stands for `typst` in a build without the feature `typeset`: the same functions, which refuse.

use crate::problem::{Problem, Problems};
use crate::report::study::Document;
use crate::report::view::ReportData;

/// A file carried inside the PDF.
#[derive(Clone, Copy, Debug)]
pub struct Attachment<'a> {
    pub name: &'a str,
    pub mime: &'a str,
    pub bytes: &'a [u8],
    pub description: &'a str,
}

/// A typeset report; there is none in this build.
#[derive(Debug)]
pub struct Pdf {
    pub bytes: Vec<u8>,
    pub pages: usize,
    pub warnings: Problems,
}

/// Refuses: this build has no typesetter.
///
/// # Errors
///
/// `no-typesetter`, always.
pub fn typeset(_: &ReportData, _: &[(String, String)], _: &[Attachment<'_>]) -> Result<Pdf, Problems> {
    Err(refusal())
}

/// Refuses, as [`typeset`].
///
/// # Errors
///
/// `no-typesetter`, always.
pub fn typeset_study(_: &Document, _: &[(String, String)], _: &[Attachment<'_>]) -> Result<Pdf, Problems> {
    Err(refusal())
}

fn refusal() -> Problems {
    let says = "this program was built without the typesetter, so it cannot write a PDF";
    let help = "build it with the feature `typeset`, or ask for `--only html` or `--only results`";
    Problems(vec![Problem::error("no-typesetter", says).help(help)])
}
