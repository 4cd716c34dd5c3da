//! Replaces `typst` in a build without the feature `typeset`: the same function, which returns an
//! error.

use crate::problem::{Problem, Problems};
use crate::report::{
    document::Document,
    pdf::{Attachment, Pdf},
};

/// Refuses: this build has no typesetter.
///
/// # Errors
///
/// `no-typesetter`, always.
pub fn typeset(
    _: &Document,
    _: &[(String, String)],
    _: &[Attachment<'_>],
) -> Result<Pdf, Problems> {
    let says = "this program was built without the typesetter and cannot write a PDF";
    let help = "build it with the feature `typeset`, or use `--only html` or `--only results`";
    Err(Problem::error("no-typesetter", says).help(help).into())
}
