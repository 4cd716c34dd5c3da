//! Records in an object store, as Parquet.

use super::held::Held;
use crate::problem::Problem;
use crate::source::Span;
use crate::store::{Object, Refused};

/// An object, and where its parts are kept that are read again. Of an object, the footer and the
/// wanted columns of the row groups that are needed are read, and nothing else.
#[derive(Clone, Debug)]
pub struct Stored {
    pub(super) object: Object,
    pub(super) held: Held,
}

impl Stored {
    /// The name in messages and results.
    pub fn url(&self) -> &str {
        self.object.url()
    }
}

/// Why an object is not read, as a problem at the place where its URL is written.
pub(super) fn refused(why: &Refused, at: &Span) -> Problem {
    let problem = Problem::error(why.code, why.says.clone()).at(at);
    match &why.help {
        Some(help) => problem.help(help.clone()),
        None => problem,
    }
}
