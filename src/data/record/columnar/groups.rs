//! The numbers of a row group, batch by batch.

use std::{ops::Range, sync::Arc};

use arrow_array::{
    Array, RecordBatch,
    cast::AsArray,
    types::{
        ArrowPrimitiveType, Float16Type, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type,
        Int64Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
    },
};
use arrow_schema::DataType;
use parquet::{
    DecodeResult,
    arrow::{
        ProjectionMask,
        arrow_reader::RowSelection,
        push_decoder::{ParquetPushDecoderBuilder, PushBuffers},
    },
};

use super::{Column, Heading, guard, open::Opened, value_at};
use crate::data::{
    faults::Faults,
    record::decoded::Numbers,
    record::layout::{Layout, damaged, guarded},
};
use crate::problem::{Problem, problem};

/// Rows decoded at a time: the numbers of twenty channels take 1 MB, which stays in the
/// second-level cache.
const BATCH: usize = 1 << 13;

/// Called after each batch with the columns and the row of the file with which the batch begins; it
/// may empty the columns.
pub type Each<'e> = &'e mut dyn FnMut(&mut [Column], usize);

/// Takes the numbers of a batch into the columns; the last argument gives the place of each column
/// in the batch.
type Take<'t> = &'t mut dyn FnMut(&RecordBatch, &mut [Column], &[usize]) -> Result<(), String>;

/// Rows of one group, with the bytes of the wanted columns.
struct Chunks {
    group: usize,
    rows: Range<usize>,
    bytes: PushBuffers,
}

impl Opened<'_> {
    /// Appends the numbers of rows of one group, numbered as in the file, to the columns, in SI
    /// units.
    pub fn rows(
        &mut self,
        rows: Range<usize>,
        columns: &mut [Column],
        faults: &mut Faults<'_>,
        each: Each<'_>,
    ) -> Result<(), Problem> {
        let (shown, layout) = (self.shown, Arc::clone(&self.layout));
        let mut fault = |row: usize, column: &Column, value: Option<f64>| {
            let place = format!("row {}, in row group {}", row + 1, layout.group_of(row) + 1);
            faults
                .push(|| wrong(shown, &layout.headings[column.position], row, value).label(place));
        };
        self.rows_told(rows, columns, &mut fault, each)
    }

    /// The numbers of some columns in rows of one group; `None` for a column with a fault there.
    pub fn block(&mut self, rows: Range<usize>, columns: &[Column]) -> Vec<Numbers> {
        let mut columns: Vec<Column> = columns.iter().map(Column::empty).collect();
        columns.iter_mut().for_each(|column| column.values.reserve_exact(rows.len()));
        let mut faulty = vec![false; self.layout.headings.len()];
        let mut fault = |_: usize, column: &Column, _: Option<f64>| faulty[column.position] = true;
        let done = self.rows_told(rows, &mut columns, &mut fault, &mut |_, _| {});
        let good = |column: Column| {
            (done.is_ok() && !faulty[column.position]).then(|| Arc::new(column.values))
        };
        columns.into_iter().map(good).collect()
    }

    fn rows_told(
        &mut self,
        rows: Range<usize>,
        columns: &mut [Column],
        fault: Fault<'_>,
        each: Each<'_>,
    ) -> Result<(), Problem> {
        if rows.is_empty() || columns.is_empty() {
            return Ok(());
        }
        let chunks = self.chunks(rows, columns)?;
        let rows = &chunks.rows;
        let mut next = rows.start;
        let decoded = self.decode(&chunks, columns, &mut |batch, columns, order| {
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
        Err(self.where_damaged(&chunks, columns, &why))
    }

    /// All values of a column of texts.
    pub fn texts(&mut self, column: &Column) -> Result<Vec<String>, Problem> {
        let mut texts: Vec<String> = Vec::new();
        for rows in self.layout.groups().into_iter().filter(|rows| !rows.is_empty()) {
            let mut alone = [column.empty()];
            let chunks = self.chunks(rows, &alone)?;
            let decoded = self.decode(&chunks, &mut alone, &mut |batch, _, _| {
                let array = batch.columns().first().and_then(|array| array.as_string_opt::<i32>());
                let array = array.ok_or("an array of another type than its schema says")?;
                texts.extend(array.iter().map(|text| text.unwrap_or_default().to_string()));
                Ok(())
            });
            decoded.map_err(|why| self.where_damaged(&chunks, &alone, &why))?;
        }
        Ok(texts)
    }

    /// The bytes of the wanted columns in rows of a group, with checked sizes.
    fn chunks(&mut self, rows: Range<usize>, columns: &[Column]) -> Result<Chunks, Problem> {
        let (shown, layout, size) = (self.shown, Arc::clone(&self.layout), self.store.size());
        let group = layout.group_of(rows.start);
        let chunk = |column: &Column| layout.chunk(group, column.position);
        let inside = |chunk| guard::range(chunk).filter(|range| range.end <= size);
        let ahead: Vec<_> = columns.iter().filter_map(|column| inside(chunk(column)?)).collect();
        self.store.ahead(&ahead, shown)?;
        let mut bytes = PushBuffers::default();
        let mut memory = 0_u64;
        for column in columns {
            let bad = |why: &str| damaged(shown, &in_column(group, column, why));
            let chunk = chunk(column).ok_or_else(|| bad("no values"))?;
            let range = inside(chunk).ok_or_else(|| bad("its values lie outside the file"))?;
            memory += range.end - range.start;
            self.within(memory, "a row group")?;
            let read = self.store.read(range.clone(), shown)?;
            if !layout.is_sound(group, column.position, &read) {
                return Err(bad("its bytes are not those that were written (checksum)"));
            }
            memory += guard::pages(&read, chunk).map_err(|why| bad(&why))?;
            bytes.push_range(range, read);
            self.within(memory, "a row group")?;
        }
        Ok(Chunks { group, rows, bytes })
    }

    fn decode(
        &self,
        Chunks { group, rows, bytes }: &Chunks,
        columns: &mut [Column],
        take: Take<'_>,
    ) -> Result<(), String> {
        let Layout { metadata, fields, .. } = self.layout.as_ref();
        // A batch has the columns in the order of the file.
        let mut order: Vec<usize> = (0..columns.len()).collect();
        order.sort_by_key(|at| columns[*at].position);
        let leaves = columns.iter().filter_map(|column| fields.get(column.position)?.leaf);
        let mask = ProjectionMask::leaves(metadata.parquet_schema(), leaves);
        let all = self.layout.groups()[*group].clone();
        guarded(|| {
            let mut builder = ParquetPushDecoderBuilder::new_with_metadata(metadata.clone())
                .with_row_groups(vec![*group])
                .with_projection(mask)
                .with_batch_size(BATCH)
                .with_buffers(bytes.clone());
            if *rows != all {
                let part = rows.start - all.start..rows.end - all.start;
                let part = RowSelection::from_consecutive_ranges(std::iter::once(part), all.len());
                builder = builder.with_row_selection(part);
            }
            let mut decoder = builder.build()?;
            loop {
                match decoder.try_decode()? {
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
    fn where_damaged(&self, chunks: &Chunks, columns: &[Column], why: &str) -> Problem {
        let Chunks { group, rows, .. } = chunks;
        for column in columns {
            let mut found = 0;
            let alone = self.decode(chunks, &mut [column.empty()], &mut |batch, _, _| {
                found += batch.num_rows();
                Ok(())
            });
            let why = match alone {
                Ok(()) if found == rows.len() => continue,
                Ok(()) => format!("{found} values where {} are declared", rows.len()),
                Err(why) => why,
            };
            let heading = &self.layout.headings[column.position];
            let at = value_at(self.shown, heading, rows.start + found, "?");
            return damaged(self.shown, &in_column(*group, column, &why)).at(&at);
        }
        damaged(self.shown, &format!("row group {}: {why}", group + 1))
    }
}

fn in_column(group: usize, column: &Column, why: &str) -> String {
    format!("row group {}, column `{}`: {why}", group + 1, column.name)
}

/// A value that is missing or not finite.
pub fn wrong(shown: &str, heading: &Heading, row: usize, value: Option<f64>) -> Problem {
    let name = &heading.name;
    let at = |text: &str| value_at(shown, heading, row, text);
    let Some(value) = value else {
        return problem!(
            "not-a-number",
            &at("null"),
            "`{name}`: the value is missing (null); expected a number"
        );
    };
    problem!("not-finite", &at(&value.to_string()), "`{name}`: `{value}` is not a finite number")
}

/// Takes a faulty value: its row in the file, its column, and what stands there.
pub type Fault<'f> = &'f mut dyn FnMut(usize, &Column, Option<f64>);

/// Appends the numbers of an array to a column, in SI units; `first` is the row of its first one.
pub fn append(
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
