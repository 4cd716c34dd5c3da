//! Records as Parquet files. The settings are fixed, so that the same numbers give the same bytes.

use std::{
    collections::HashMap,
    io::{self, Write as _},
    ops::Range,
    sync::Arc,
};

use arrow_array::{ArrayRef, Float64Array, RecordBatch, StringArray};
use arrow_schema::{DataType, Field, Schema};
use flate2::write::DeflateEncoder;
use parquet::{
    arrow::ArrowWriter,
    basic::{Compression, ZstdLevel},
    errors::ParquetError,
    file::{
        metadata::KeyValue,
        properties::{EnabledStatistics, WriterProperties, WriterPropertiesBuilder},
    },
    schema::types::ColumnPath,
};

use super::digits::Digits;
use crate::data::checksum;
use crate::problem::{Problem, problem};

/// Rows of a row group: 80 s at 200 Hz, so that the record of a section is one group, and a stretch
/// of a long run needs one or two groups of 5 km at 60 m/s. With fewer rows, dictionaries and
/// footers take a larger share of the file.
const GROUP: usize = 1 << 14;
/// Level of compression: higher levels save some percent of the size and take several times as
/// long.
const LEVEL: i32 = 3;
/// A column is not compressed unless this saves at least so much of its size. Numbers of seven
/// digits with noise would become a fifth smaller, and reading them would take four times as long.
const LEAST_SAVED: f64 = 0.25;
/// Numbers that are compressed for a trial.
const TRIED: usize = 1 << 13;
/// A column with at most this share of different values in its rows is written with a dictionary: a
/// speed that hardly changes, a flag.
const DICTIONARY: f64 = 1.0 / 16.0;
/// Bytes after the footer: its length and the magic number.
const TAIL: usize = 8;

/// The values of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    Numbers(Vec<f64>),
    Texts(Vec<String>),
}

impl Values {
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Texts(texts) => texts.len(),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Those of a range of rows that are there.
    fn part(&self, range: Range<usize>) -> Self {
        let range = range.start.min(self.len())..range.end.min(self.len());
        match self {
            Self::Numbers(values) => Self::Numbers(values[range].to_vec()),
            Self::Texts(texts) => Self::Texts(texts[range].to_vec()),
        }
    }
}

/// A column as it is in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct FileColumn {
    /// `name [unit]`, as in the header of a text.
    pub heading: String,
    pub values: Values,
    /// How its numbers are written in a text, if all are written alike. It is in the metadata of
    /// the field.
    pub digits: Option<Digits>,
}

/// What a column is in a Parquet file, by all its values.
#[derive(Clone, Debug)]
pub struct Layout {
    pub heading: String,
    kind: DataType,
    digits: Option<Digits>,
    dictionary: bool,
    compressed: bool,
}

impl Layout {
    pub fn of(column: &FileColumn) -> Self {
        let (kind, dictionary, compressed) = match &column.values {
            Values::Numbers(values) => {
                let few = different(values) <= DICTIONARY;
                (DataType::Float64, few, few || saved(values) >= LEAST_SAVED)
            }
            Values::Texts(_) => (DataType::Utf8, true, true),
        };
        let (heading, digits) = (column.heading.clone(), column.digits);
        Self { heading, kind, digits, dictionary, compressed }
    }
}

/// Writes a Parquet file of so many rows; `part` gives the values of all columns in a range of
/// rows, a row group at a time.
///
/// # Errors
/// `write-failed`: columns of different length, or two of the same name; the system's error. That
/// of `part`.
pub fn parquet_in_groups(
    layouts: &[Layout],
    rows: usize,
    mut part: impl FnMut(Range<usize>) -> Result<Vec<Values>, Problem>,
    sink: impl io::Write + Send,
) -> Result<(), Problem> {
    let properties = properties().map_err(failed)?;
    let mut properties = properties.set_max_row_group_row_count(Some(GROUP));
    let mut fields = Vec::new();
    for layout in layouts {
        let path = ColumnPath::new(vec![layout.heading.clone()]);
        properties = properties.set_column_dictionary_enabled(path.clone(), layout.dictionary);
        if !layout.compressed {
            properties = properties.set_column_compression(path, Compression::UNCOMPRESSED);
        }
        let metadata = layout.digits.map(Digits::metadata).into_iter();
        let metadata: HashMap<_, _> =
            metadata.map(|(key, value)| (key.to_string(), value)).collect();
        let field = Field::new(&layout.heading, layout.kind.clone(), false);
        fields.push(field.with_metadata(metadata));
    }
    let schema = Arc::new(Schema::new(fields));
    let held = Held { sink, bytes: Vec::new(), before: 0 };
    let mut writer = ArrowWriter::try_new(held, Arc::clone(&schema), Some(properties.build()))
        .map_err(failed)?;
    let mut sums = checksum::blank();
    for start in (0..rows).step_by(GROUP) {
        let array = |values: Values| -> ArrayRef {
            match values {
                Values::Numbers(values) => Arc::new(Float64Array::from(values)),
                Values::Texts(texts) => Arc::new(StringArray::from(texts)),
            }
        };
        let arrays = part(start..rows.min(start + GROUP))?.into_iter().map(array).collect();
        let batch = RecordBatch::try_new(Arc::clone(&schema), arrays).map_err(failed)?;
        writer.write(&batch).and_then(|()| writer.flush()).map_err(failed)?;
        writer.sync().map_err(failed)?;
        let group = writer.flushed_row_groups().last().map(|group| group.columns().to_vec());
        let held = writer.inner_mut();
        sums.extend(group.iter().flatten().map(|column| held.checksum(column.byte_range())));
        held.pass_on().map_err(failed)?;
    }
    // Of a file without rows, the magic number is still held.
    writer.sync().and_then(|()| writer.inner_mut().pass_on()).map_err(failed)?;
    writer.append_key_value_metadata(KeyValue::new(checksum::KEY.into(), sums));
    let mut held = writer.into_inner().map_err(failed)?;
    let end = held.bytes.len().saturating_sub(TAIL);
    checksum::close(&mut held.bytes[..end]);
    held.pass_on().map_err(failed)
}

/// Holds back the bytes of a row group, and of the footer, until their checksums are known.
struct Held<W> {
    sink: W,
    bytes: Vec<u8>,
    /// Bytes that were passed on.
    before: u64,
}

impl<W: io::Write> Held<W> {
    /// Of a part of the file, which is held.
    fn checksum(&self, (start, length): (u64, u64)) -> String {
        let at = start.saturating_sub(self.before) as usize;
        checksum::of_column(self.bytes.get(at..at + length as usize).unwrap_or_default())
    }

    fn pass_on(&mut self) -> io::Result<()> {
        self.sink.write_all(&self.bytes)?;
        self.before += self.bytes.len() as u64;
        self.bytes.clear();
        Ok(())
    }
}

impl<W> io::Write for Held<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.bytes.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn failed(error: impl std::fmt::Display) -> Problem {
    problem!("write-failed", "a record cannot be written as Parquet: {error}")
}

/// Rows of the longest column.
pub fn rows_of(columns: &[FileColumn]) -> usize {
    columns.iter().map(|column| column.values.len()).max().unwrap_or(0)
}

/// The bytes of a Parquet file.
///
/// # Errors
/// `write-failed`: columns of different length, or two of the same name.
pub fn parquet(columns: &[FileColumn]) -> Result<Vec<u8>, Problem> {
    let layouts: Vec<Layout> = columns.iter().map(Layout::of).collect();
    let mut bytes = Vec::new();
    let part = |range: Range<usize>| {
        Ok(columns.iter().map(|column| column.values.part(range.clone())).collect())
    };
    parquet_in_groups(&layouts, rows_of(columns), part, &mut bytes)?;
    Ok(bytes)
}

/// How many different values a column has for each of its rows.
fn different(values: &[f64]) -> f64 {
    let mut bits: Vec<u64> = values.iter().map(|value| value.to_bits()).collect();
    bits.sort_unstable();
    bits.dedup();
    bits.len() as f64 / values.len().max(1) as f64
}

/// The share of its size that a column would save, by a trial.
fn saved(values: &[f64]) -> f64 {
    let bytes: Vec<u8> = values.iter().take(TRIED).flat_map(|value| value.to_le_bytes()).collect();
    let mut compressed = DeflateEncoder::new(Vec::new(), flate2::Compression::fast());
    // Writing to memory cannot fail.
    let _ = compressed.write_all(&bytes);
    let size = compressed.finish().map_or(bytes.len(), |compressed| compressed.len());
    1.0 - size as f64 / bytes.len().max(1) as f64
}

/// How Parquet files are written.
///
/// # Errors
/// None of this level of compression.
pub fn properties() -> Result<WriterPropertiesBuilder, ParquetError> {
    Ok(WriterProperties::builder()
        // Without a version, so that a new one of the library does not change the bytes.
        .set_created_by(checksum::WRITER.to_string())
        // Where pages begin: nothing here reads it, and it has no checksum.
        .set_offset_index_disabled(true)
        .set_compression(Compression::ZSTD(ZstdLevel::try_new(LEVEL)?))
        // Of row groups: readers skip by them. Those of pages would be as large as some columns.
        .set_statistics_enabled(EnabledStatistics::Chunk))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two decimals are compressed; noise in all digits is not.
    #[test]
    fn compression_is_for_columns_that_it_makes_smaller() {
        let noise = |n: i32| {
            f64::from(n.wrapping_mul(1_103_515_245).wrapping_add(12_345) >> 3) * 1.234_567_89e-7
        };
        let all: Vec<f64> = (0..5000).map(noise).collect();
        let rounded: Vec<f64> = all.iter().map(|value| (value * 10.0).round() / 100.0).collect();
        assert!(
            saved(&all) < LEAST_SAVED && saved(&rounded) > LEAST_SAVED,
            "{} {}",
            saved(&all),
            saved(&rounded)
        );
        assert!(
            different(&all) > 0.9 && different(&[1.0; 100]) <= DICTIONARY && different(&[]) == 0.0
        );
    }
}
