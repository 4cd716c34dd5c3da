//! The rows of a text as numbers.

use super::{Column, fault};
use crate::data::{
    faults::Faults,
    text::{LONGEST_LINE, long_line},
};
use crate::problem::Problem;

/// Replaces the values of the columns by those of a text of whole rows; returns the number of rows.
/// `before`: number of rows of the file before these. After a fault, columns may have different
/// lengths.
///
/// # Errors
/// `line-too-long`; what is wrong with a row is added to the faults.
pub fn read(
    text: &str,
    width: usize,
    columns: &mut [Column],
    (shown, before): (&str, usize),
    faults: &mut Faults<'_>,
) -> Result<usize, Problem> {
    columns.iter_mut().for_each(|column| column.values.clear());
    // In the order of the file, so that faults are reported in order.
    let mut columns: Vec<&mut Column> = columns.iter_mut().collect();
    columns.sort_by_key(|column| column.position);
    // Blank lines at the end are not rows.
    let rows = text.trim_end();
    if rows.is_empty() {
        return Ok(0);
    }
    let ended = rows.len() < text.len();
    let (mut starts, mut count, mut from) = (Vec::with_capacity(width), 0, 0);
    while from <= rows.len() {
        let end =
            memchr::memchr(b'\n', &rows.as_bytes()[from..]).map_or(rows.len(), |at| from + at);
        let line = rows[from..end].trim_end_matches('\r');
        let number = before + count + 2;
        if line.len() > LONGEST_LINE {
            return Err(long_line(line.as_bytes(), number, shown));
        }
        if row(line.as_bytes(), width, &mut starts, &mut columns).is_none() {
            columns.iter_mut().for_each(|column| column.values.truncate(count));
            let last = end == rows.len() && !text[end..].contains('\n');
            let line = fault::Line { text: line, number, last, shown };
            fault::slow_row(&line, width, &mut columns, faults);
        }
        // A faulty row is counted, so that later rows have the right numbers.
        count += 1;
        from = end + 1;
    }
    if faults.is_empty() {
        fault::cut_number(rows, ended, before + count + 1, shown, faults);
    }
    Ok(count)
}

/// Adds the numbers of a row to the columns. `None` if the row is irregular; some columns may then
/// have one value more. `starts` is memory for the starts of the cells.
fn row(
    line: &[u8],
    width: usize,
    starts: &mut Vec<usize>,
    columns: &mut [&mut Column],
) -> Option<()> {
    starts.clear();
    starts.push(0);
    for at in memchr::memchr2_iter(b',', b'"', line) {
        if line[at] == b'"' {
            return None;
        }
        starts.push(at + 1);
    }
    if starts.len() != width {
        return None;
    }
    starts.push(line.len() + 1);
    for column in columns {
        let cell = &line[starts[column.position]..starts[column.position + 1] - 1];
        let number: f64 =
            fast_float2::parse(cell).ok().filter(|number: &f64| number.is_finite())?;
        column.values.push(number * column.unit.factor);
    }
    Some(())
}
