//! The rows of a record, in one pass over the bytes.

use super::{Column, fault, number};
use crate::problem::Problem;

/// Rows reserved for before the first is read are bounded by what a row of one-digit numbers takes.
const SHORTEST_CELL: usize = 2;

/// Fills the columns from the text below the header; the number of rows.
pub(super) fn read(body: &str, width: usize, columns: &mut [Column], shown: &str) -> Result<usize, Vec<Problem>> {
    let bytes = body.as_bytes();
    let mut slots = vec![None; width];
    for (slot, column) in columns.iter_mut().enumerate() {
        slots[column.position] = Some(slot);
        column.values.reserve(expected_rows(bytes, width));
    }
    let mut sinks: Vec<Sink> =
        columns.iter_mut().map(|column| Sink { factor: column.unit.factor, values: std::mem::take(&mut column.values) }).collect();
    let mut faults = fault::Faults::new(shown);
    let mut at = 0;
    let mut rows = 0;
    while at < bytes.len() {
        if let Some(next) = row(bytes, at, &slots, &mut sinks) {
            at = next;
        } else {
            for sink in &mut sinks {
                sink.values.truncate(rows);
            }
            let end = memchr::memchr(b'\n', &bytes[at..]).map_or(bytes.len(), |found| at + found);
            if body[at..].trim().is_empty() {
                break;
            }
            let line = fault::Line { text: body[at..end].trim_end_matches('\r'), number: rows + 2, last: end == bytes.len(), shown };
            // A faulty row still counts, so that the rows after it keep their numbers.
            fault::slow_row(&line, &slots, &mut sinks, &mut faults);
            at = end + 1;
        }
        rows += 1;
    }
    if rows == 0 {
        faults.push(|| Problem::error("no-rows", format!("`{shown}` has a header and no samples")));
    }
    for (column, sink) in columns.iter_mut().zip(sinks) {
        column.values = sink.values;
    }
    faults.finish(rows)
}

/// Where the numbers of a column go.
pub(super) struct Sink {
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

/// Reads the row beginning at `at`; the start of the next row, or `None` if anything about it is unusual.
fn row(bytes: &[u8], mut at: usize, slots: &[Option<usize>], sinks: &mut [Sink]) -> Option<usize> {
    let last = slots.len() - 1;
    for (n, slot) in slots.iter().enumerate() {
        if let Some(slot) = slot {
            let (number, length) = number::plain(&bytes[at..]).or_else(|| fast_float2::parse_partial(&bytes[at..]).ok())?;
            if !number.is_finite() {
                return None;
            }
            let sink = &mut sinks[*slot];
            sink.values.push(number * sink.factor);
            at += length;
        } else {
            at += bytes[at..].iter().position(|byte| matches!(byte, b',' | b'\n' | b'"' | b'\r')).unwrap_or(bytes.len() - at);
        }
        if n < last {
            if bytes.get(at) != Some(&b',') {
                return None;
            }
            at += 1;
        }
    }
    match bytes.get(at..) {
        None | Some([]) => Some(at),
        Some([b'\n', ..]) => Some(at + 1),
        Some([b'\r', b'\n', ..]) => Some(at + 2),
        Some(_) => None,
    }
}
