//! Where a record is: in a file, in an object store, or in memory. All readers of records go through
//! here.

use std::{ops::Range, path::Path, sync::Arc};

use super::{
    Column, Format, Record, Wanted,
    columnar::{self, At},
    known::Known,
    memory::Frame,
    stored::Stored,
    stretch::{Block, Run},
    text,
};
use crate::data::{cells::Heading, place::CampaignPath, prelude::*};

/// A record that can be read.
#[derive(Clone, Debug)]
pub enum RecordSource {
    File(CampaignPath),
    Object(Stored),
    Memory(Arc<Frame>),
}

/// How the rows of a record lie.
enum Form<'a> {
    Text(&'a Path),
    Parquet(At<'a>),
    Memory(&'a Arc<Frame>),
}

impl RecordSource {
    /// A file that is not part of a campaign; `shown` is its name in messages.
    pub fn at(path: &Path, shown: &str) -> Self {
        let (path, shown) = (path.to_path_buf(), shown.to_string());
        Self::File(CampaignPath { path, inside: shown.clone(), shown })
    }

    /// The name in messages and results: the path inside the campaign.
    pub fn inside(&self) -> &str {
        match self {
            Self::File(place) => &place.inside,
            Self::Object(stored) => stored.object.url(),
            Self::Memory(frame) => &frame.name,
        }
    }

    fn form(&self) -> Form<'_> {
        match self {
            Self::File(place) => match Format::of(&place.path) {
                Format::Csv => Form::Text(&place.path),
                Format::Parquet => Form::Parquet(At::Disk(&place.path)),
            },
            Self::Object(stored) => Form::Parquet(At::Object(stored)),
            Self::Memory(frame) => Form::Memory(frame),
        }
    }

    /// Number of the first row in messages: the header of a text is row 1.
    pub fn first_row(&self) -> usize {
        match self.form() {
            Form::Text(_) => 2,
            Form::Parquet(_) | Form::Memory(_) => 1,
        }
    }

    /// The headings of all columns.
    ///
    /// # Errors
    /// As [`Self::read`], of the file and its header.
    pub fn headings(&self) -> Result<Vec<Heading>, Vec<Problem>> {
        match self.form() {
            Form::Text(path) => text::headings(path, self.inside()),
            Form::Parquet(at) => columnar::headings(at, self.inside()),
            Form::Memory(frame) => Ok(frame.headings.clone()),
        }
    }

    /// Reads the requested columns; all other cells are ignored.
    ///
    /// # Errors
    /// At most a handful of problems and how many more there are. Of the file: `file-missing`,
    /// `file-unreadable`, `file-empty`, `file-too-large`, `encoding`, `no-rows`. Of its header:
    /// `semicolon-separated`, `tab-separated`, `stray-quote`, `duplicate-column`,
    /// `unknown-channel`, `unit-missing`, `unknown-unit`, `unit-mismatch`, `units-in-row`,
    /// `units-in-cell`. Of a row: `header-repeated`, `ragged-row`, `truncated-row`, `blank-line`,
    /// `stray-quote`, `not-a-number`, `not-finite`, `decimal-comma`, `line-too-long`.
    ///
    /// Of a Parquet file: `format-mislabelled`, `format-not-read` (compression, encryption),
    /// `file-damaged`, `unit-conflict`. Of a record in memory those of its columns and values.
    pub fn read(&self, wanted: &[Wanted]) -> Result<Record, Vec<Problem>> {
        let run = match self.form() {
            Form::Text(path) => text::read(path, self.inside(), wanted),
            Form::Parquet(at) => columnar::read(at, self.inside(), wanted),
            Form::Memory(frame) => frame.read(wanted),
        };
        Ok(self.record(run?, 0))
    }

    fn record(&self, run: Run, first_row: usize) -> Record {
        Record {
            shown: self.inside().to_string(),
            columns: run.columns,
            channels: run.channels,
            rows: run.rows,
            first_row,
            sha256: run.sha256,
            bytes: usize::try_from(run.bytes).unwrap_or(usize::MAX),
            from: self.clone(),
        }
    }

    /// Reads the rows of a record whose axis lies in a range, in SI units with both ends, with the
    /// hash of the whole file. `axis` is one of the wanted columns; `known` is what is known of the
    /// file, if it was read before. Row groups of a Parquet file whose statistics exclude the range
    /// are not decoded. A text is read to its end once, for its hash and an index; then only the
    /// blocks that touch the range.
    ///
    /// # Errors
    /// As [`Self::read`], of the rows that are decoded; `axis-not-increasing` if rows outside lie
    /// between those inside; `outside-record` if none lies inside.
    pub fn stretch(
        &self,
        wanted: &[Wanted],
        axis: &str,
        range: Range<f64>,
        known: &Known,
    ) -> Result<Record, Vec<Problem>> {
        let (shown, part) = (self.inside(), (axis, &range));
        let (run, stretch) = match self.form() {
            Form::Text(path) => text::stretch(path, shown, wanted, part, known),
            Form::Parquet(at) => columnar::stretch(at, shown, wanted, part, known),
            Form::Memory(frame) => frame.stretch(wanted, part),
        }?;
        let (run, first_row) = stretch.end(run, shown, self.first_row())?;
        Ok(self.record(run, first_row))
    }

    /// Reads the requested columns of a record of any length, block by block in the order of the
    /// file; `axis` is one of them. What [`Self::stretch`] needs to know of the file is kept in
    /// `known`. Memory does not grow with the length of a text; of a Parquet file one row group of
    /// these columns is held, compressed.
    ///
    /// # Errors
    /// As [`Self::read`]; blocks before the first one with a fault were given to `each`.
    /// `record-in-memory`.
    pub fn stream(
        &self,
        wanted: &[Wanted],
        axis: &str,
        known: &Known,
        mut each: impl FnMut(&Block<'_>),
    ) -> Result<Run, Vec<Problem>> {
        let shown = self.inside();
        match self.form() {
            Form::Text(path) => {
                let (run, file) = text::stream_indexed(path, shown, wanted, axis, &mut each)?;
                known.keep(file);
                Ok(run)
            }
            Form::Parquet(at) => columnar::stream(at, shown, wanted, known, &mut each),
            Form::Memory(frame) => Err(in_memory(frame).into()),
        }
    }

    /// The place of sample `row`, from 0, or of its cell in a column. The file is read again.
    pub fn place(&self, row: usize, column: Option<&Column>) -> Option<Span> {
        match self.form() {
            Form::Text(path) => text::place(path, self.inside(), row, column),
            Form::Parquet(at) => columnar::place(at, self.inside(), row, column),
            Form::Memory(frame) => frame.place(row, column),
        }
    }

    /// The file, for who copies it or hands it to another program.
    ///
    /// # Errors
    /// `record-in-memory`, `record-in-store`.
    pub fn file(self, at: &Span) -> Result<CampaignPath, Problem> {
        match self {
            Self::File(place) => Ok(place),
            Self::Object(_) => {
                let inside = self.inside();
                Err(problem!(
                    "record-in-store",
                    at,
                    "the record `{inside}` is in a store, and a file is needed here"
                )
                .help("copy the records to the campaign's folder"))
            }
            Self::Memory(frame) => Err(in_memory(&frame).at(at)),
        }
    }
}

fn in_memory(frame: &Frame) -> Problem {
    problem!(
        "record-in-memory",
        "the record `{}` is in memory, and a file is needed here",
        frame.name
    )
    .help("write the records to a campaign folder")
}
