//! Where a record is: in a file, in an object store, or in memory. All readers of records of a
//! campaign go through here.

use std::ops::Range;
use std::sync::Arc;

use super::memory::Frame;
use super::{
    Block, Format, Known, Record, Run, Stored, Wanted, read_headings, read_record, read_stretch,
    stream_known,
};
use crate::data::cells::Heading;
use crate::data::folder::Place;
use crate::problem::Problem;
use crate::source::Span;

/// A record that can be read.
#[derive(Clone, Debug)]
pub enum RecordSource {
    File(Place),
    Object(Stored),
    Memory(Arc<Frame>),
}

impl RecordSource {
    /// The name in messages and results: the path inside the campaign.
    pub fn inside(&self) -> &str {
        match self {
            Self::File(place) => &place.inside,
            Self::Object(stored) => stored.url(),
            Self::Memory(frame) => frame.name(),
        }
    }

    /// Number of the first row in messages: the header of a text is row 1.
    pub fn first_row(&self) -> usize {
        match self {
            Self::File(place) if Format::of(&place.path) == Format::Csv => 2,
            Self::File(_) | Self::Object(_) | Self::Memory(_) => 1,
        }
    }

    /// # Errors
    /// As [`read_headings`].
    pub fn headings(&self) -> Result<Vec<Heading>, Vec<Problem>> {
        match self {
            Self::File(place) => read_headings(&place.path, &place.inside),
            Self::Object(stored) => stored.headings(),
            Self::Memory(frame) => Ok(frame.headings()),
        }
    }

    /// # Errors
    /// As [`read_record`]; of a record in memory those of its columns and values.
    pub fn read(&self, wanted: &[Wanted]) -> Result<Record, Vec<Problem>> {
        match self {
            Self::File(place) => read_record(&place.path, &place.inside, wanted),
            Self::Object(stored) => stored.read(wanted),
            Self::Memory(frame) => frame.read(wanted),
        }
    }

    /// The rows whose axis lies in a range; `known` is what is known of the file.
    ///
    /// # Errors
    /// As [`read_stretch`].
    pub fn stretch(
        &self,
        wanted: &[Wanted],
        axis: &str,
        range: Range<f64>,
        known: &Known,
    ) -> Result<Record, Vec<Problem>> {
        match self {
            Self::File(place) => {
                read_stretch(&place.path, &place.inside, wanted, axis, range, known)
            }
            Self::Object(stored) => stored.stretch(wanted, axis, range, known),
            Self::Memory(frame) => frame.stretch(wanted, axis, range),
        }
    }

    /// All rows, block by block; `axis` is one of the wanted columns.
    ///
    /// # Errors
    /// As [`stream_known`]; `record-in-memory`.
    pub fn stream(
        &self,
        wanted: &[Wanted],
        axis: &str,
        known: &Known,
        mut each: impl FnMut(&Block<'_>),
    ) -> Result<Run, Vec<Problem>> {
        match self {
            Self::File(place) => {
                stream_known(&place.path, &place.inside, wanted, (axis, known), each)
            }
            Self::Object(stored) => stored.stream(wanted, known, &mut each),
            Self::Memory(frame) => Err(vec![in_memory(frame)]),
        }
    }

    /// The file, for who copies it or hands it to another program.
    ///
    /// # Errors
    /// `record-in-memory`, `record-in-store`.
    pub fn file(self, at: &Span) -> Result<Place, Problem> {
        match self {
            Self::File(place) => Ok(place),
            Self::Object(stored) => {
                let says = format!(
                    "the record `{}` is in a store, and a file is needed here",
                    stored.url()
                );
                Err(Problem::error("record-in-store", says)
                    .at(at)
                    .help("copy the records to the campaign's folder"))
            }
            Self::Memory(frame) => Err(in_memory(&frame).at(at)),
        }
    }
}

fn in_memory(frame: &Frame) -> Problem {
    let says = format!("the record `{}` is in memory, and a file is needed here", frame.name());
    Problem::error("record-in-memory", says).help("write the records to a campaign folder")
}
