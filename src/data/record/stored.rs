//! Records in an object store, as Parquet.

use std::ops::Range;

use super::columnar::{self, At};
use super::held::Held;
use super::stretch::{Block, Run};
use super::{Known, Record, Wanted};
use crate::data::cells::Heading;
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

    /// # Errors
    /// As [`super::read_headings`] of a Parquet file.
    pub fn headings(&self) -> Result<Vec<Heading>, Vec<Problem>> {
        columnar::headings(At::Object(self), self.url())
    }

    /// # Errors
    /// As [`super::read_record`] of a Parquet file.
    pub fn read(&self, wanted: &[Wanted]) -> Result<Record, Vec<Problem>> {
        columnar::read(At::Object(self), self.url(), wanted)
    }

    /// # Errors
    /// As [`super::read_stretch`] of a Parquet file.
    pub fn stretch(
        &self,
        wanted: &[Wanted],
        axis: &str,
        range: Range<f64>,
        known: &Known,
    ) -> Result<Record, Vec<Problem>> {
        columnar::stretch(At::Object(self), self.url(), wanted, (axis, &range), known)
    }

    /// # Errors
    /// As [`super::stream`] of a Parquet file.
    pub fn stream(
        &self,
        wanted: &[Wanted],
        known: &Known,
        each: &mut dyn FnMut(&Block<'_>),
    ) -> Result<Run, Vec<Problem>> {
        columnar::stream(At::Object(self), self.url(), wanted, known, each)
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
