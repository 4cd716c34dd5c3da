//! A record in memory: columns as Arrow arrays, which are not copied.

use std::fmt;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

use arrow_array::cast::AsArray;
use arrow_array::types::Float64Type;
use arrow_array::{Array, RecordBatch};
use arrow_schema::{DataType, Schema};

use super::columnar::{append, headings_of, no_rows, not_numbers, numbers, value_at, wrong};
use super::stretch::{Run, Stretch, axis_of, values};
use super::{Column, Wanted, find_columns};
use crate::data::cells::Heading;
use crate::data::faults::Faults;
use crate::data::hash::Hasher;
use crate::problem::Problem;
use crate::source::{Source, Span};

/// Numbers hashed at a time where they do not lie as 64-bit numbers in memory; it does not change
/// the result.
const BLOCK: usize = 4096;

/// A table that is used as a record. The unit of a column stands in brackets after its name, or in
/// the metadata of its field under `unit`.
pub struct Frame {
    /// The path inside the campaign that the record has, such as `measurement/S01`; with the ending
    /// of the file that it was read from.
    name: String,
    headings: Vec<Heading>,
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

impl fmt::Debug for Frame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Frame")
            .field("name", &self.name)
            .field("rows", &self.rows)
            .finish_non_exhaustive()
    }
}

impl Frame {
    /// # Errors
    /// `unit-conflict`, `duplicate-column`; `file-empty`: the table has no columns.
    pub fn new(name: &str, schema: &Schema, batches: Vec<RecordBatch>) -> Result<Self, Problem> {
        if schema.fields().is_empty() {
            return Err(Problem::error("file-empty", format!("`{name}` has no columns")));
        }
        let headings = headings_of(schema, schema, name)?;
        let rows = batches.iter().map(RecordBatch::num_rows).sum();
        Ok(Self {
            name: name.to_string(),
            headings,
            batches,
            rows,
            hash: OnceLock::new(),
            bytes: None,
        })
    }

    /// The same table, which was read from a file as it is: results then name the file.
    #[must_use]
    pub fn read_from(self, file: ReadFrom) -> Self {
        Self {
            name: format!("{}.{}", self.name, file.ending),
            hash: OnceLock::from(file.sha256),
            bytes: Some(file.bytes),
            ..self
        }
    }

    /// The path inside the campaign that the record has.
    pub fn name(&self) -> &str {
        &self.name
    }

    pub(super) fn headings(&self) -> Vec<Heading> {
        self.headings.clone()
    }

    /// The wanted columns, with their numbers in SI units.
    pub(super) fn read(&self, wanted: &[Wanted]) -> Result<Run, Vec<Problem>> {
        Ok(Run {
            channels: self.headings.iter().map(|heading| heading.name.clone()).collect(),
            rows: self.rows,
            columns: self.columns(wanted)?,
            sha256: self.sha256(),
            bytes: self.bytes() as u64,
        })
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
        let kind = |column: &Column| {
            Some(self.batches.first()?.schema_ref().field(column.position).data_type().clone())
        };
        let other = |column: &Column| {
            not_numbers(&kind(column)?, &column.name, &self.headings.get(column.position)?.span)
        };
        let problems: Vec<Problem> =
            columns.iter().filter_map(other).map(|problem| problem.help(CONVERT)).collect();
        if !problems.is_empty() {
            return Err(problems);
        }
        if self.rows == 0 {
            return Err(vec![no_rows(&self.name)]);
        }
        let mut faults = Faults::new(&self.name);
        for column in &mut columns {
            column.values.reserve_exact(self.rows);
            let mut first = 0;
            for batch in &self.batches {
                let mut fault = |row: usize, column: &Column, value: Option<f64>| {
                    faults.push(|| {
                        wrong(&self.name, &self.headings[column.position], row, value)
                            .label(format!("row {}", row + 1))
                    });
                };
                let done =
                    append(batch.column(column.position).as_ref(), column, first, &mut fault);
                done.map_err(|why| {
                    vec![
                        Problem::error("not-a-number", format!("`{}`: {why}", self.name))
                            .help(CONVERT),
                    ]
                })?;
                first += batch.num_rows();
            }
        }
        faults.finish(columns)
    }

    /// Bytes of the file, or of the numbers.
    fn bytes(&self) -> usize {
        if let Some(bytes) = self.bytes {
            return bytes;
        }
        self.rows.saturating_mul(self.headings.len()).saturating_mul(8)
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
            return Some(
                Source::excerpt(self.name.as_str(), format!("row {}", row + 1), row + 1).whole(),
            );
        };
        let mut first = 0;
        for batch in &self.batches {
            if row < first + batch.num_rows() {
                let mut value = Vec::new();
                let array = batch.column(column.position).slice(row - first, 1);
                numbers(array.as_ref(), 1.0, &mut value)?;
                return Some(value_at(
                    &self.name,
                    self.headings.get(column.position)?,
                    row,
                    &value.first()?.to_string(),
                ));
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
    let mut texts = |texts: &mut dyn Iterator<Item = Option<&str>>| {
        texts.for_each(|text| {
            [text.unwrap_or_default().as_bytes(), &[0]]
                .into_iter()
                .for_each(|bytes| hash.add(bytes))
        });
    };
    match array.data_type() {
        DataType::Utf8 => return texts(&mut array.as_string::<i32>().iter()),
        DataType::LargeUtf8 => return texts(&mut array.as_string::<i64>().iter()),
        DataType::Utf8View => return texts(&mut array.as_string_view().iter()),
        _ => {}
    }
    let mut values = Vec::new();
    if numbers(array.as_ref(), 1.0, &mut values).is_none() {
        // What is neither numbers nor text is never read.
        return hash.add(array.data_type().to_string().as_bytes());
    }
    for block in values.chunks(BLOCK) {
        hash.add(&block.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>());
    }
}
