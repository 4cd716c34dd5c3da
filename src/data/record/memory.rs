//! A record in memory: columns as Arrow arrays, which are not copied.

use std::{
    ops::Range,
    sync::{Arc, OnceLock},
};

use arrow_array::{Array, RecordBatch, cast::AsArray, types::Float64Type};
use arrow_schema::{DataType, Schema};

use super::{
    Column, Wanted,
    columnar::{append, no_rows, numbers, value_at, wrong},
    find_columns,
    layout::{headings_of, not_numbers},
    stretch::{Run, Stretch, axis_of, values},
};
use crate::data::{
    cells::{Heading, names},
    faults::Faults,
    hash::Hasher,
    prelude::*,
};

/// Numbers hashed at a time where they do not lie as 64-bit numbers in memory; it does not change
/// the result.
const BLOCK: usize = 4096;

/// A table that is used as a record. The unit of a column stands in brackets after its name, or in
/// the metadata of its field under `unit`.
#[derive(Debug)]
pub struct Frame {
    /// The path inside the campaign that the record has, such as `measurement/S01`; with the ending
    /// of the file that it was read from.
    pub name: String,
    pub(super) headings: Vec<Heading>,
    batches: Vec<RecordBatch>,
    rows: usize,
    hash: OnceLock<String>,
    /// Bytes of the file that it was read from.
    bytes: Option<usize>,
}

/// A file from which a table was read as it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadFrom {
    /// Ending of its name, without the point.
    pub ending: &'static str,
    pub sha256: String,
    pub bytes: usize,
}

/// Why a table in memory has no numbers, and what mends it.
const CONVERT: &str = "convert the column to float64";

impl Frame {
    /// # Errors
    /// `unit-conflict`, `duplicate-column`; `file-empty`: the table has no columns.
    pub fn new(name: &str, schema: &Schema, batches: Vec<RecordBatch>) -> Result<Self, Problem> {
        if schema.fields().is_empty() {
            return Err(problem!("file-empty", "`{name}` has no columns"));
        }
        let headings = headings_of(schema, schema, name)?;
        let rows = batches.iter().map(RecordBatch::num_rows).sum();
        let (name, hash) = (name.to_string(), OnceLock::new());
        Ok(Self { name, headings, batches, rows, hash, bytes: None })
    }

    /// The same table, which was read from a file as it is: results then name the file.
    pub fn read_from(self, file: ReadFrom) -> Self {
        Self {
            name: format!("{}.{}", self.name, file.ending),
            hash: OnceLock::from(file.sha256),
            bytes: Some(file.bytes),
            ..self
        }
    }

    /// The wanted columns, with their numbers in SI units.
    pub(super) fn read(&self, wanted: &[Wanted]) -> Result<Run, Vec<Problem>> {
        let columns = self.columns(wanted)?;
        // Of the file, or of the numbers.
        let numbers = self.rows.saturating_mul(self.headings.len()).saturating_mul(8);
        let bytes = self.bytes.unwrap_or(numbers) as u64;
        let (channels, sha256) = (names(&self.headings), self.sha256());
        Ok(Run { channels, rows: self.rows, columns, sha256, bytes })
    }

    /// The rows whose axis lies in a range of SI units.
    pub(super) fn stretch(
        &self,
        wanted: &[Wanted],
        (axis, range): (&str, &Range<f64>),
    ) -> Result<(Run, Stretch), Vec<Problem>> {
        let run = self.read(wanted)?;
        let at = axis_of(&run.columns, axis, &self.name)?;
        let mut stretch = Stretch::new(range.clone(), at, &run.columns);
        stretch.add(&values(&run.columns), 0);
        Ok((run, stretch))
    }

    fn columns(&self, wanted: &[Wanted]) -> Result<Vec<Column>, Vec<Problem>> {
        let mut columns = find_columns(&self.headings, wanted, &self.name)?;
        let other = |column: &Column| {
            let schema = self.batches.first()?.schema_ref();
            let (kind, at) = (schema.field(column.position).data_type(), column.position);
            let problem = not_numbers(kind, &column.name, &self.headings.get(at)?.span)?;
            Some(problem.help(CONVERT))
        };
        let problems: Vec<Problem> = columns.iter().filter_map(other).collect();
        if !problems.is_empty() {
            return Err(problems);
        }
        if self.rows == 0 {
            return Err(no_rows(&self.name).into());
        }
        let mut faults = Faults::new(&self.name);
        let mut fault = |row: usize, column: &Column, value: Option<f64>| {
            let heading = &self.headings[column.position];
            let label = format!("row {}", row + 1);
            faults.push(|| wrong(&self.name, heading, row, value).label(label));
        };
        for column in &mut columns {
            column.values.reserve_exact(self.rows);
            let mut first = 0;
            for batch in &self.batches {
                let array = batch.column(column.position).as_ref();
                append(array, column, first, &mut fault).map_err(|why| {
                    problem!("not-a-number", "`{}`: {why}", self.name).help(CONVERT)
                })?;
                first += batch.num_rows();
            }
        }
        faults.finish(columns)
    }

    /// SHA-256 of the content, which does not depend on how it lies in memory: for each column its
    /// heading, a zero byte, and its numbers as 64-bit floating-point numbers, lowest byte first;
    /// texts with a zero byte after each. A missing number is a NaN.
    fn sha256(&self) -> String {
        let compute = || {
            let mut hash = Hasher::default();
            for (position, heading) in self.headings.iter().enumerate() {
                hash.add(heading.span.text().as_bytes());
                hash.add(&[0]);
                for batch in &self.batches {
                    add(&mut hash, batch.column(position));
                }
            }
            hash.finish()
        };
        self.hash.get_or_init(compute).clone()
    }

    /// The place of a sample, from 0, or of its value in a column.
    pub(super) fn place(&self, row: usize, column: Option<&Column>) -> Option<Span> {
        let Some(column) = column else {
            let text = format!("row {}", row + 1);
            return Some(Source::excerpt(self.name.as_str(), text, row + 1).whole());
        };
        let mut first = 0;
        for batch in &self.batches {
            if row < first + batch.num_rows() {
                let mut value = Vec::new();
                let array = batch.column(column.position).slice(row - first, 1);
                numbers(array.as_ref(), 1.0, &mut value)?;
                let heading = self.headings.get(column.position)?;
                return Some(value_at(&self.name, heading, row, &value.first()?.to_string()));
            }
            first += batch.num_rows();
        }
        None
    }
}

/// Adds the values of an array to a hash.
fn add(hash: &mut Hasher, array: &Arc<dyn Array>) {
    if let Some(numbers) =
        array.as_primitive_opt::<Float64Type>().filter(|numbers| numbers.null_count() == 0)
        && cfg!(target_endian = "little")
    {
        return hash.add(numbers.values().inner().as_slice());
    }
    let texts: &mut dyn Iterator<Item = Option<&str>> = match array.data_type() {
        DataType::Utf8 => &mut array.as_string::<i32>().iter(),
        DataType::LargeUtf8 => &mut array.as_string::<i64>().iter(),
        DataType::Utf8View => &mut array.as_string_view().iter(),
        _ => return add_numbers(hash, array),
    };
    for text in texts {
        hash.add(text.unwrap_or_default().as_bytes());
        hash.add(&[0]);
    }
}

fn add_numbers(hash: &mut Hasher, array: &Arc<dyn Array>) {
    let mut values = Vec::new();
    if numbers(array.as_ref(), 1.0, &mut values).is_none() {
        // What is neither numbers nor text is never read.
        return hash.add(array.data_type().to_string().as_bytes());
    }
    for block in values.chunks(BLOCK) {
        hash.add(&block.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>());
    }
}
