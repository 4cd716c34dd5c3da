//! The rows of a record, in one pass over the bytes.

use super::{Column, fault, marks::Marks, number};
use crate::data::faults::Faults;
use crate::data::text::{LONGEST_LINE, long_line};
use crate::problem::Problem;

/// Rows reserved for before the first is read are bounded by what a row of one-digit numbers takes.
const SHORTEST_CELL: usize = 2;

/// Fills the columns from the text below the header, which begins at `start`; the number of rows.
pub(super) fn read(text: &str, start: usize, width: usize, columns: &mut [Column], shown: &str) -> Result<usize, Vec<Problem>> {
    let bytes = text.as_bytes();
    let expected = expected_rows(&bytes[start..], width);
    let sink = |column: &Column| Sink {
        name: column.name.clone(),
        position: column.position,
        factor: column.unit.factor,
        values: Vec::with_capacity(expected),
    };
    // In the order of the file, in which their faults are told.
    let mut columns: Vec<&mut Column> = columns.iter_mut().collect();
    columns.sort_by_key(|column| column.position);
    let mut sinks: Vec<Sink> = columns.iter().map(|column| sink(column)).collect();
    let mut faults = Faults::new(shown);
    let mut marks = Marks::default();
    let mut rows = 0;
    let mut at = start;
    // Blank lines at the end are no rows.
    let end_of_rows = start + text[start..].trim_end().len();
    'file: while at < end_of_rows {
        let stretch = at;
        marks.find(bytes, stretch);
        let mut cells = marks.after();
        while at < marks.end.min(end_of_rows) {
            if row(bytes, cells, width, &mut sinks).is_some() {
                cells = &cells[width..];
                at = cells[0];
                rows += 1;
                continue;
            }
            for sink in &mut sinks {
                sink.values.truncate(rows);
            }
            let end = memchr::memchr(b'\n', &bytes[at..]).map_or(bytes.len(), |found| at + found);
            if end >= marks.end && at > stretch {
                // Cut off by the end of the stretch: the next one begins with it.
                break;
            }
            if end - at > LONGEST_LINE {
                faults.push(|| long_line(&bytes[at..end], rows + 2, shown));
                break 'file;
            }
            let line = fault::Line { text: text[at..end].trim_end_matches('\r'), number: rows + 2, last: end == bytes.len(), shown };
            // A faulty row still counts, so that the rows after it keep their numbers.
            fault::slow_row(&line, width, &mut sinks, &mut faults);
            rows += 1;
            at = end + 1;
            cells = &cells[cells.partition_point(|mark| *mark < at)..];
        }
    }
    if faults.is_empty() && rows > 0 {
        fault::cut_number(&text[start..end_of_rows], text.len() > end_of_rows, rows + 1, shown, &mut faults);
    }
    if rows == 0 {
        faults.push(|| Problem::error("no-rows", format!("`{shown}` has a header and no samples")));
    }
    for (column, sink) in columns.into_iter().zip(sinks) {
        column.values = sink.values;
    }
    faults.finish(rows)
}

/// Where the numbers of a column go.
pub(super) struct Sink {
    pub name: String,
    /// Which cell of a row.
    pub position: usize,
    pub factor: f64,
    pub values: Vec<f64>,
}

/// A guess from the first row, so that columns seldom grow.
fn expected_rows(bytes: &[u8], width: usize) -> usize {
    let first = memchr::memchr(b'\n', bytes).unwrap_or(bytes.len()) + 1;
    // A first row that is shorter than the others would reserve too much, so it is taken for at least as long as a row can be.
    let rows = bytes.len() / first.max(SHORTEST_CELL * width);
    rows + rows / 16 + 1
}

/// Reads the row whose cells begin at the first `width` marks; the mark after them is where the next row begins.
///
/// `None` if anything about it is unusual; some columns may then have a value more.
// Inlined, it would compete with the loop around it for registers.
#[inline(never)]
fn row(bytes: &[u8], cells: &[usize], width: usize, sinks: &mut [Sink]) -> Option<()> {
    let (cells, next) = (cells.get(..width)?, *cells.get(width)?);
    // Quotes and missing cells show up where only commas should be.
    if bytes[next - 1] != b'\n' || !cells[1..].iter().all(|cell| bytes[cell - 1] == b',') {
        return None;
    }
    let end = if bytes[next - 2] == b'\r' { next - 2 } else { next - 1 };
    for sink in sinks {
        let cell = cells[sink.position]..cells.get(sink.position + 1).map_or(end, |next| next - 1);
        sink.values.push(number::read(bytes, cell)? * sink.factor);
    }
    Some(())
}
