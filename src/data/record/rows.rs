//! The rows of a record, in one pass over the bytes.

use std::ops::Range;

use super::lanes::{self, Lanes, Work};
use super::sink::Sink;
use super::{Column, fault, marks::Marks};
use crate::data::faults::Faults;
use crate::data::hash::{self, Hasher};
use crate::data::text::{LONGEST_LINE, long_line};
use crate::problem::Problem;

/// Shortest cell in bytes, which bounds the number of rows reserved.
const SHORTEST_CELL: usize = 2;

/// Which part of a file a text is.
#[derive(Clone, Copy)]
pub(super) struct Part<'a> {
    /// Name of the file.
    pub shown: &'a str,
    /// Number of rows before it.
    pub before: usize,
}

/// Fills the columns from the text below the header, which begins at `start`; returns the number of
/// rows. The bytes of the text, header included, are added to the hash on the way: it waits for its
/// own results most of the time, in which numbers can be read.
pub(super) fn read(
    text: &str,
    start: usize,
    width: usize,
    columns: &mut [Column],
    part: Part<'_>,
    hash: Option<&mut Hasher>,
) -> Result<usize, Vec<Problem>> {
    let Part { shown, before } = part;
    let expected = expected_rows(&text.as_bytes()[start..], width);
    let sink = |column: &Column| Sink {
        name: column.name.clone(),
        position: column.position,
        factor: column.unit.factor,
        values: Vec::with_capacity(expected),
    };
    // In the order of the file, so that faults are reported in order.
    let mut columns: Vec<&mut Column> = columns.iter_mut().collect();
    columns.sort_by_key(|column| column.position);
    // Blank lines at the end are not rows.
    let end = start + text[start..].trim_end().len();
    let reading = Reading {
        text,
        rows: start..end,
        width,
        sinks: columns.iter().map(|column| sink(column)).collect(),
        faults: Faults::new(shown),
        part,
        hashed: Hashed { hash, bytes: text.as_bytes(), at: 0 },
    };
    let (rows, sinks, mut faults) = lanes::fastest(reading);
    if faults.is_empty() && rows > 0 {
        fault::cut_number(
            &text[start..end],
            text.len() > end,
            before + rows + 1,
            shown,
            &mut faults,
        );
    }
    if before + rows == 0 {
        faults.push(|| Problem::error("no-rows", format!("`{shown}` has a header and no samples")));
    }
    for (column, sink) in columns.into_iter().zip(sinks) {
        column.values = sink.values;
    }
    faults.finish(rows)
}

/// The bytes of a text on their way into a hash.
struct Hashed<'a> {
    hash: Option<&'a mut Hasher>,
    bytes: &'a [u8],
    at: usize,
}

impl Hashed<'_> {
    /// Adds a block, unless all before `end` are added.
    #[inline(always)]
    fn step(&mut self, end: usize) {
        if let (Some(hash), Some(block)) =
            (&mut self.hash, self.bytes.get(self.at..self.at + hash::BLOCK))
            && self.at < end
        {
            hash.add(block);
            self.at += hash::BLOCK;
        }
    }

    /// Adds all whole blocks up to `end`.
    #[inline(always)]
    fn up_to(&mut self, end: usize) {
        while self.hash.is_some() && self.at + hash::BLOCK <= end {
            self.step(end);
        }
    }

    fn finish(&mut self) {
        if let Some(hash) = &mut self.hash {
            hash.add(&self.bytes[self.at..]);
        }
    }
}

/// The rows of a text to be read.
struct Reading<'a, 'h> {
    text: &'a str,
    rows: Range<usize>,
    width: usize,
    sinks: Vec<Sink>,
    faults: Faults<'a>,
    part: Part<'a>,
    hashed: Hashed<'h>,
}

impl<'a> Work for Reading<'a, '_> {
    type Output = (usize, Vec<Sink>, Faults<'a>);

    #[inline(always)]
    fn run(self, lanes: impl Lanes) -> Self::Output {
        let Self {
            text,
            rows: Range { start, end: end_of_rows },
            width,
            mut sinks,
            mut faults,
            part,
            mut hashed,
        } = self;
        let Part { shown, before } = part;
        let bytes = text.as_bytes();
        let mut marks = Marks::default();
        let mut rows = 0;
        let mut at = start;
        'file: while at < end_of_rows {
            let stretch = at;
            marks.find(lanes, bytes, stretch);
            let mut cells = marks.after();
            while at < marks.end.min(end_of_rows) {
                if row(lanes, bytes, cells, width, &mut sinks, &mut hashed).is_some() {
                    cells = &cells[width..];
                    at = cells[0];
                    rows += 1;
                    continue;
                }
                for sink in &mut sinks {
                    sink.values.truncate(rows);
                }
                let end =
                    memchr::memchr(b'\n', &bytes[at..]).map_or(bytes.len(), |found| at + found);
                if end >= marks.end && at > stretch {
                    // Cut off by the end of the block: the next block begins with it.
                    break;
                }
                if end - at > LONGEST_LINE {
                    faults.push(|| long_line(&bytes[at..end], before + rows + 2, shown));
                    break 'file;
                }
                let line = fault::Line {
                    text: text[at..end].trim_end_matches('\r'),
                    number: before + rows + 2,
                    last: end == bytes.len(),
                    shown,
                };
                // A faulty row is counted, so that later rows have the right numbers.
                fault::slow_row(&line, width, &mut sinks, &mut faults);
                rows += 1;
                at = end + 1;
                cells = &cells[cells.partition_point(|mark| *mark < at)..];
            }
        }
        hashed.finish();
        (rows, sinks, faults)
    }
}

/// Estimate from the first row, so that columns seldom grow.
fn expected_rows(bytes: &[u8], width: usize) -> usize {
    let first = memchr::memchr(b'\n', bytes).unwrap_or(bytes.len()) + 1;
    // A short first row would reserve too much, so its length is at least the minimum.
    let rows = bytes.len() / first.max(SHORTEST_CELL * width);
    rows + rows / 16 + 1
}

/// Numbers that are read while a block is hashed: about as long as that takes by itself.
const BETWEEN: usize = 6;

/// Parses the row whose cells begin at the first `width` marks; the next mark is the start of the
/// next row.
///
/// `None` if the row is irregular; some columns may then have one value more.
#[inline(always)]
fn row(
    lanes: impl Lanes,
    bytes: &[u8],
    cells: &[usize],
    width: usize,
    sinks: &mut [Sink],
    hashed: &mut Hashed<'_>,
) -> Option<()> {
    let (cells, next) = (cells.get(..width)?, *cells.get(width)?);
    // Quotes and missing cells are detected where only commas are expected.
    if bytes[next - 1] != b'\n' || !cells[1..].iter().all(|cell| bytes[cell - 1] == b',') {
        return None;
    }
    let end = if bytes[next - 2] == b'\r' { next - 2 } else { next - 1 };
    for sinks in sinks.chunks_mut(BETWEEN) {
        for sink in sinks {
            let cell =
                cells[sink.position]..cells.get(sink.position + 1).map_or(end, |next| next - 1);
            sink.values.push(lanes.number(bytes, cell)? * sink.factor);
        }
        hashed.step(next);
    }
    hashed.up_to(next);
    Some(())
}
