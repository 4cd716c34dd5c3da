//! A typeset report as bytes, and the files that it carries; with or without a typesetter in the
//! build.

use crate::problem::Problems;

/// A file carried inside the PDF.
#[derive(Clone, Copy, Debug)]
pub struct Attachment<'a> {
    /// File name as readers list it: `results.json`.
    pub name: &'a str,
    /// Media type: `application/json`.
    pub mime: &'a str,
    pub bytes: &'a [u8],
    pub description: &'a str,
}

/// A typeset report.
#[derive(Debug)]
pub struct Pdf {
    pub bytes: Vec<u8>,
    pub pages: usize,
    /// What the typesetter remarked without giving up; empty unless a template is at fault.
    pub warnings: Problems,
}
