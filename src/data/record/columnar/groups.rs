//! The numbers of a row group, batch by batch.

use std::ops::Range;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::{
    ArrowPrimitiveType, Float16Type, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type,
    Int64Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, RecordBatch};
use arrow_schema::DataType;
use parquet::DecodeResult;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::RowSelection;
use parquet::arrow::push_decoder::{ParquetPushDecoderBuilder, PushBuffers};

use super::layout::{damaged, guarded};
use super::open::Opened;
use super::{Column, Heading, guard, value_at};
use crate::data::faults::Faults;
use crate::data::record::decoded::Numbers;
use crate::problem::Problem;

/// Rows decoded at a time: the numbers of twenty channels take 1 MB, which stays in the
/// second-level cache.
const BATCH: usize = 1 << 13;

/// Called after each batch with the columns and the row of the file with which the batch begins; it
/// may empty the columns.
pub(super) type Each<'e> = &'e mut dyn FnMut(&mut [Column], usize);

/// Takes the numbers of a batch into the columns; the last argument gives the place of each column
/// in the batch.
type Take<'t> = &'t mut dyn FnMut(&RecordBatch, &mut [Column], &[usize]) -> Result<(), String>;

impl Opened<'_> {
    /// Appends the numbers of a group to the columns, in SI units.
    pub(super) fn group(
        &mut self,
        group: usize,
        columns: &mut [Column],
        faults: &mut Faults<'_>,
        each: Each<'_>,
    ) -> Result<(), Problem> {
        let rows = self.layout.rows_of(group);
        self.rows_in(group, rows, columns, faults, each)
    }

    /// The same for some rows of the group, by their numbers in the file.
    pub(super) fn rows_in(
        &mut self,
        group: usize,
        rows: Range<usize>,
        columns: &mut [Column],
        faults: &mut Faults<'_>,
        each: Each<'_>,
    ) -> Result<(), Problem> {
        let (shown, layout) = (self.shown, Arc::clone(&self.layout));
        let mut fault = |row: usize, column: &Column, value: Option<f64>| {
            let place = format!("row {}, in row group {}", row + 1, group + 1);
            faults.push(|| {
                wrong(shown, &layout.headings()[column.position], row, value).label(place)
            });
        };
        self.rows_told(group, rows, columns, &mut fault, each)
    }

    /// The numbers of some columns in some rows of a group; `None` for a column with a fault there.
    pub(super) fn block(
        &mut self,
        group: usize,
        rows: Range<usize>,
        columns: &[Column],
    ) -> Vec<Numbers> {
        let empty =
            |column: &Column| Column { values: Vec::with_capacity(rows.len()), ..column.clone() };
        let mut columns: Vec<Column> = columns.iter().map(empty).collect();
        let mut faulty = vec![false; self.layout.headings().len()];
        let mut fault = |_: usize, column: &Column, _: Option<f64>| faulty[column.position] = true;
        let done = self.rows_told(group, rows, &mut columns, &mut fault, &mut |_, _| {});
        let good = |column: Column| {
            (done.is_ok() && !faulty[column.position]).then(|| Arc::new(column.values))
        };
        columns.into_iter().map(good).collect()
    }

    fn rows_told(
        &mut self,
        group: usize,
        rows: Range<usize>,
        columns: &mut [Column],
        fault: Fault<'_>,
        each: Each<'_>,
    ) -> Result<(), Problem> {
        if rows.is_empty() || columns.is_empty() {
            return Ok(());
        }
        let chunks = self.chunks(group, columns)?;
        let mut next = rows.start;
        let decoded = self.decode(group, &rows, &chunks, columns, &mut |batch, columns, order| {
            for (array, at) in batch.columns().iter().zip(order) {
                append(array.as_ref(), &mut columns[*at], next, fault)?;
            }
            each(columns, next);
            next += batch.num_rows();
            Ok(())
        });
        let why = match decoded {
            Ok(()) if next == rows.end => return Ok(()),
            Ok(()) => format!("{} rows where {} are declared", next - rows.start, rows.len()),
            Err(why) => why,
        };
        Err(self.where_damaged(group, &rows, &chunks, columns, &why))
    }

    /// All values of a column of texts.
    pub(super) fn texts(&mut self, column: &Column) -> Result<Vec<String>, Problem> {
        let mut texts: Vec<String> = Vec::new();
        let columns = std::slice::from_ref(column);
        for group in 0..self.layout.groups() {
            let rows = self.layout.rows_of(group);
            if rows.is_empty() {
                continue;
            }
            let chunks = self.chunks(group, columns)?;
            let mut one = [Column { values: Vec::new(), ..column.clone() }];
            let decoded = self.decode(group, &rows, &chunks, &mut one, &mut |batch, _, _| {
                let array = batch.columns().first().and_then(|array| array.as_string_opt::<i32>());
                let array = array.ok_or("an array of another type than its schema says")?;
                texts.extend(array.iter().map(|text| text.unwrap_or_default().to_string()));
                Ok(())
            });
            decoded.map_err(|why| self.where_damaged(group, &rows, &chunks, columns, &why))?;
        }
        Ok(texts)
    }

    /// The bytes of the wanted columns of a group, with checked sizes.
    fn chunks(&mut self, group: usize, columns: &[Column]) -> Result<PushBuffers, Problem> {
        let shown = self.shown;
        let mut chunks = PushBuffers::default();
        let mut memory = 0_u64;
        self.store.ahead(&self.ranges(group, columns), shown)?;
        for column in columns {
            let place = || format!("row group {}, column `{}`", group + 1, column.name);
            let Some(leaf) = self.layout.leaf(column.position) else {
                return Err(damaged(shown, &format!("{}: no values", place())));
            };
            let chunk = self.layout.metadata.metadata().row_group(group).column(leaf);
            let range = guard::range(chunk).filter(|range| range.end <= self.store.size());
            let range = range.ok_or_else(|| {
                damaged(shown, &format!("{}: its values lie outside the file", place()))
            })?;
            memory += range.end - range.start;
            self.within(memory, "a row group")?;
            let bytes = self.store.read(range.clone(), shown)?;
            let pages = guard::pages(&bytes, chunk)
                .map_err(|why| damaged(shown, &format!("{}: {why}", place())))?;
            chunks.push_range(range, bytes);
            memory += pages.memory;
            self.within(memory, "a row group")?;
        }
        Ok(chunks)
    }

    /// Where the wanted columns of a group are, as far as it lies inside the file.
    fn ranges(&self, group: usize, columns: &[Column]) -> Vec<Range<u64>> {
        let group = self.layout.metadata.metadata().row_group(group);
        let leaves = columns.iter().filter_map(|column| self.layout.leaf(column.position));
        leaves
            .filter_map(|leaf| {
                guard::range(group.column(leaf)).filter(|range| range.end <= self.store.size())
            })
            .collect()
    }

    fn decode(
        &self,
        group: usize,
        rows: &Range<usize>,
        chunks: &PushBuffers,
        columns: &mut [Column],
        take: Take<'_>,
    ) -> Result<(), String> {
        // A batch has the columns in the order of the file.
        let mut order: Vec<usize> = (0..columns.len()).collect();
        order.sort_by_key(|at| columns[*at].position);
        let leaves = columns.iter().filter_map(|column| self.layout.leaf(column.position));
        let mask = ProjectionMask::leaves(self.layout.metadata.parquet_schema(), leaves);
        let all = self.layout.rows_of(group);
        let part = rows.start - all.start..rows.end - all.start;
        guarded(|| {
            let said = |error: parquet::errors::ParquetError| error.to_string();
            let mut builder =
                ParquetPushDecoderBuilder::new_with_metadata(self.layout.metadata.clone())
                    .with_row_groups(vec![group])
                    .with_projection(mask)
                    .with_batch_size(BATCH)
                    .with_buffers(chunks.clone());
            if *rows != all {
                builder = builder.with_row_selection(RowSelection::from_consecutive_ranges(
                    [part].into_iter(),
                    all.len(),
                ));
            }
            let mut decoder = builder.build().map_err(said)?;
            loop {
                match decoder.try_decode().map_err(said)? {
                    DecodeResult::Data(batch) => take(&batch, columns, &order)?,
                    DecodeResult::Finished => return Ok(()),
                    DecodeResult::NeedsData(_) => {
                        return Err("its values lie outside the column".into());
                    }
                }
            }
        })
    }

    /// Which column is damaged: each is decoded alone.
    fn where_damaged(
        &self,
        group: usize,
        rows: &Range<usize>,
        chunks: &PushBuffers,
        columns: &[Column],
        why: &str,
    ) -> Problem {
        for column in columns {
            let mut found = 0;
            let mut one = [Column { values: Vec::new(), ..column.clone() }];
            let alone = self.decode(group, rows, chunks, &mut one, &mut |batch, _, _| {
                found += batch.num_rows();
                Ok(())
            });
            let why = match alone {
                Ok(()) if found == rows.len() => continue,
                Ok(()) => format!("{found} values where {} are declared", rows.len()),
                Err(why) => why,
            };
            let row = rows.start + found;
            let problem = damaged(
                self.shown,
                &format!("row group {}, column `{}`: {why}", group + 1, column.name),
            );
            return problem.at(&value_at(
                self.shown,
                &self.layout.headings()[column.position],
                row,
                "?",
            ));
        }
        damaged(self.shown, &format!("row group {}: {why}", group + 1))
    }
}

/// A value that is missing or not finite.
pub(in crate::data::record) fn wrong(
    shown: &str,
    heading: &Heading,
    row: usize,
    value: Option<f64>,
) -> Problem {
    let (code, says, text) = match value {
        None => (
            "not-a-number",
            "the value is missing (null); expected a number".to_string(),
            "null".to_string(),
        ),
        Some(value) => {
            ("not-finite", format!("`{value}` is not a finite number"), value.to_string())
        }
    };
    Problem::error(code, format!("`{}`: {says}", heading.name))
        .at(&value_at(shown, heading, row, &text))
}

/// Takes a faulty value: its row in the file, its column, and what stands there.
pub(in crate::data::record) type Fault<'f> = &'f mut dyn FnMut(usize, &Column, Option<f64>);

/// Appends the numbers of an array to a column, in SI units; `first` is the row of its first one.
pub(in crate::data::record) fn append(
    array: &dyn Array,
    column: &mut Column,
    first: usize,
    fault: Fault<'_>,
) -> Result<(), String> {
    let (from, factor) = (column.values.len(), column.unit.factor);
    numbers(array, factor, &mut column.values).ok_or_else(|| {
        format!("the column `{}` holds {} instead of numbers", column.name, array.data_type())
    })?;
    if column.values[from..].iter().any(|value| !value.is_finite()) {
        let mut written = Vec::new();
        numbers(array, 1.0, &mut written);
        for (row, value) in written.into_iter().enumerate() {
            if !column.values[from + row].is_finite() {
                fault(first + row, column, array.is_valid(row).then_some(value));
            }
        }
    }
    Ok(())
}

/// Appends the numbers of an array times a factor; NaN where it has none. `None` if it holds no
/// numbers. Integers from 2^53 are rounded to the nearest double, as the same digits in a text are.
pub(crate) fn numbers(array: &dyn Array, factor: f64, to: &mut Vec<f64>) -> Option<()> {
    macro_rules! all {
        ($($kind:ident => $type:ty),*) => {
            match array.data_type() {
                $(DataType::$kind => extend::<$type>(array, factor, to, |value| value as f64),)*
                DataType::Float16 => {
                    extend::<Float16Type>(array, factor, to, |value| value.to_f64())
                }
                _ => None,
            }
        };
    }
    all!(
        Float64 => Float64Type, Float32 => Float32Type, Int8 => Int8Type, Int16 => Int16Type,
        Int32 => Int32Type, Int64 => Int64Type, UInt8 => UInt8Type, UInt16 => UInt16Type,
        UInt32 => UInt32Type, UInt64 => UInt64Type
    )
}

fn extend<T: ArrowPrimitiveType>(
    array: &dyn Array,
    factor: f64,
    to: &mut Vec<f64>,
    convert: impl Fn(T::Native) -> f64,
) -> Option<()> {
    let array = array.as_primitive_opt::<T>()?;
    if array.null_count() == 0 {
        to.extend(array.values().iter().map(|value| convert(*value) * factor));
    } else {
        to.extend(
            array.iter().map(|value| value.map_or(f64::NAN, |value| convert(value) * factor)),
        );
    }
    Some(())
}
