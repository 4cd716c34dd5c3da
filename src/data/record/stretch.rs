//! Blocks of a long record, and the rows of a record inside a range of its axis.

use std::ops::Range;

use super::Column;
use crate::problem::{Problem, problem};

/// Consecutive rows of a record.
#[derive(Debug)]
pub struct Block<'a> {
    /// Number of rows before this block.
    pub first_row: usize,
    pub rows: usize,
    /// As in [`super::Record::columns`], with the values of these rows.
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
    /// The requested columns; without values if these were given block by block.
    pub columns: Vec<Column>,
    /// SHA-256 of the file.
    pub sha256: String,
    /// Size of the file.
    pub bytes: u64,
}

/// Index of the axis among the columns.
pub fn axis_of(columns: &[Column], axis: &str, shown: &str) -> Result<usize, Problem> {
    columns.iter().position(|column| column.name == axis).ok_or_else(|| {
        let problem = problem!("unknown-channel", "`{shown}` has no column `{axis}`");
        problem.suggest(axis, columns.iter().map(|column| &column.name))
    })
}

/// The values of columns.
pub fn values(columns: &[Column]) -> Vec<&[f64]> {
    columns.iter().map(|column| column.values.as_slice()).collect()
}

/// The rows inside a range of the axis, collected block by block.
pub struct Stretch {
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
        let columns = columns.iter().map(Column::empty).collect();
        Self { range, axis, columns, first_row: 0, next: 0, again: None }
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

    /// What was read of these rows, and the row of the file with which they begin. `header`: the
    /// number of the first row in messages.
    ///
    /// # Errors
    /// `axis-not-increasing`, `outside-record`.
    pub fn end(self, run: Run, shown: &str, header: usize) -> Result<(Run, usize), Problem> {
        let Column { name, unit, values, .. } = &self.columns[self.axis];
        let number = |value: f64| format!("{}{}", unit.from_si(value), unit.suffix());
        let (start, end) = (number(self.range.start), number(self.range.end));
        let rows = values.len();
        if let Some(row) = self.again {
            let row = row + header;
            let says = format!(
                "`{name}` enters the range from {start} to {end} again at row {row} of `{shown}`; it must increase"
            );
            return Err(Problem::error("axis-not-increasing", says));
        }
        if rows == 0 {
            return Err(problem!(
                "outside-record",
                "no sample of `{shown}` has a `{name}` from {start} to {end}"
            ));
        }
        Ok((Run { rows, columns: self.columns, ..run }, self.first_row))
    }
}
