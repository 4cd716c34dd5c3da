//! Blocks of a long text, and the rows of a record inside a range of its axis.

use std::io::Read;
use std::ops::Range;
use std::path::Path;

use super::{Column, Origin, Record, Wanted, find_columns, header, rows};
use crate::data::hash::Hasher;
use crate::data::text::{
    LONGEST_LINE, decode_from, long_line, open_text, read_line_of, unreadable,
};
use crate::problem::Problem;
use crate::source::Source;

/// Bytes of text read at a time, and so what is read at least for a stretch: about 1200 rows of 24
/// channels, 6 s at 200 Hz. Larger blocks are not read faster.
const BLOCK: usize = 1 << 18;

/// Consecutive rows of a record.
#[derive(Debug)]
pub struct Block<'a> {
    /// Number of rows before this block.
    pub first_row: usize,
    pub rows: usize,
    /// As in [`Record::columns`], with the values of these rows.
    pub columns: &'a [Column],
    /// First and last byte of a text; of a Parquet file nothing.
    pub bytes: (u64, u64),
}

/// What is known of a record that was read to its end.
#[derive(Clone, Debug)]
pub struct Run {
    /// Every column name in the file.
    pub channels: Vec<String>,
    pub rows: usize,
    /// The requested columns without values.
    pub columns: Vec<Column>,
    /// SHA-256 of the file.
    pub sha256: String,
    /// Size of the file.
    pub bytes: u64,
}

/// Index of the axis among the columns.
pub(super) fn axis_of(columns: &[Column], axis: &str, shown: &str) -> Result<usize, Vec<Problem>> {
    columns.iter().position(|column| column.name == axis).ok_or_else(|| {
        let problem =
            Problem::error("unknown-channel", format!("`{shown}` has no column `{axis}`"));
        vec![problem.suggest(axis, columns.iter().map(|column| column.name.as_str()))]
    })
}

/// The values of columns.
pub(super) fn values(columns: &[Column]) -> Vec<&[f64]> {
    columns.iter().map(|column| column.values.as_slice()).collect()
}

/// The rows inside a range of the axis, collected block by block.
pub(super) struct Stretch {
    range: Range<f64>,
    axis: usize,
    columns: Vec<Column>,
    first_row: usize,
    /// Row of the file after the last one inside.
    next: usize,
    /// First row inside that follows rows outside.
    again: Option<usize>,
}

impl Stretch {
    pub fn new(range: Range<f64>, axis: usize, columns: &[Column]) -> Self {
        let empty = |column: &Column| Column { values: Vec::new(), ..column.clone() };
        Self {
            range,
            axis,
            columns: columns.iter().map(empty).collect(),
            first_row: 0,
            next: 0,
            again: None,
        }
    }

    /// Makes room for so many rows, so that no column is moved while it grows.
    pub fn reserve(&mut self, rows: usize) {
        self.columns.iter_mut().for_each(|column| column.values.reserve_exact(rows));
    }

    /// Adds the rows inside of a block, given by its columns.
    pub fn add(&mut self, columns: &[&[f64]], first_row: usize) {
        let axis = columns[self.axis];
        let inside = |value: &f64| *value >= self.range.start && *value <= self.range.end;
        let mut at = 0;
        while let Some(start) = axis[at..].iter().position(inside).map(|found| at + found) {
            let end = axis[start..]
                .iter()
                .position(|value| !inside(value))
                .map_or(axis.len(), |found| start + found);
            if self.next == 0 {
                self.first_row = first_row + start;
            } else if self.next != first_row + start {
                self.again = self.again.or(Some(first_row + start));
                return;
            }
            for (kept, column) in self.columns.iter_mut().zip(columns) {
                kept.values.extend_from_slice(&column[start..end]);
            }
            self.next = first_row + end;
            at = end;
        }
    }

    /// The record of these rows.
    pub fn record(self, run: Run, from: Origin, shown: &str) -> Result<Record, Vec<Problem>> {
        let axis = &self.columns[self.axis];
        let number = |value: f64| format!("{}{}", axis.unit.from_si(value), axis.unit.suffix());
        let (start, end) = (number(self.range.start), number(self.range.end));
        let (name, rows) = (axis.name.clone(), axis.values.len());
        let record = Record {
            shown: shown.to_string(),
            rows,
            columns: self.columns,
            channels: run.channels,
            first_row: self.first_row,
            sha256: run.sha256,
            bytes: usize::try_from(run.bytes).unwrap_or(usize::MAX),
            from,
        };
        if let Some(row) = self.again {
            let row = record.row_shown(row - self.first_row);
            let says = format!(
                "`{name}` enters the range from {start} to {end} again at row {row} of `{shown}`; it must increase"
            );
            return Err(vec![Problem::error("axis-not-increasing", says)]);
        }
        if record.rows == 0 {
            let says = format!("no sample of `{shown}` has a `{name}` from {start} to {end}");
            return Err(vec![Problem::error("outside-record", says)]);
        }
        Ok(record)
    }
}

/// A text, in blocks that end with a line.
pub(super) fn text(
    path: &Path,
    shown: &str,
    wanted: &[Wanted],
    each: &mut dyn FnMut(&Block<'_>),
) -> Result<Run, Vec<Problem>> {
    let one = |problem: Problem| vec![problem];
    let mut file = open_text(path, shown).map_err(one)?;
    let mut hash = Hasher::default();
    let first = read_line_of(&mut file, shown).map_err(one)?;
    hash.add(&first);
    let (headings, _) = header(decode_from(&first, shown, 1).map_err(one)?, shown)?;
    let mut columns = find_columns(&headings, wanted, shown)?;
    let (mut bytes, mut buffer, mut rows_read) = (first.len() as u64, Vec::new(), 0_usize);
    loop {
        let kept = buffer.len();
        (&mut file)
            .take(BLOCK as u64)
            .read_to_end(&mut buffer)
            .map_err(|error| one(unreadable(shown, &error)))?;
        let added = buffer.len() - kept;
        hash.add(&buffer[kept..]);
        bytes += added as u64;
        let ended = added < BLOCK;
        // The last line is left for the next block: it may be cut off, or blank lines at the end of
        // the file may follow.
        let full = buffer.trim_ascii_end().len();
        let end = if ended {
            buffer.len()
        } else {
            memchr::memrchr(b'\n', &buffer[..full]).map_or(0, |end| end + 1)
        };
        if buffer.len() - end > BLOCK.max(LONGEST_LINE) {
            return Err(one(unbroken(&buffer[end..], rows_read + 2, shown)));
        }
        if end > 0 && (full > 0 || rows_read == 0) {
            let text = decode_from(&buffer[..end], shown, rows_read + 2).map_err(one)?;
            let rows = rows::read(
                text,
                0,
                headings.len(),
                &mut columns,
                rows::Part { shown, before: rows_read },
                None,
            )?;
            let before = bytes - buffer.len() as u64;
            each(&Block {
                first_row: rows_read,
                rows,
                columns: &columns,
                bytes: (before, before + end as u64),
            });
            rows_read += rows;
            buffer.drain(..end);
        }
        if ended {
            break;
        }
    }
    if rows_read == 0 {
        return Err(one(Problem::error(
            "no-rows",
            format!("`{shown}` has a header and no samples"),
        )));
    }
    columns.iter_mut().for_each(|column| column.values = Vec::new());
    let channels = headings.into_iter().map(|heading| heading.name).collect();
    Ok(Run { channels, rows: rows_read, columns, sha256: hash.finish(), bytes })
}

/// What follows the last whole line is longer than a block.
fn unbroken(rest: &[u8], line: usize, shown: &str) -> Problem {
    if rest.iter().take(LONGEST_LINE).any(|byte| *byte == b'\n') {
        let at = Source::excerpt(shown, "", line + 1).whole();
        return Problem::error(
            "blank-line",
            format!("blank lines from line {} of `{shown}` on", line + 1),
        )
        .at(&at);
    }
    long_line(rest, line, shown)
}
