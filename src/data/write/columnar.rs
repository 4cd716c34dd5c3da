//! Records as Parquet files. The settings are fixed, so that the same numbers give the same bytes.

use std::collections::HashMap;
use std::fmt::Write;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch, StringArray};
use arrow_schema::{DataType, Field, Schema};
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, ZstdLevel};
use parquet::file::properties::{EnabledStatistics, WriterProperties};

use super::digits::Digits;
use super::table_csv;
use crate::problem::Problem;

/// Rows of a row group: 80 s at 200 Hz, so that the record of a section is one group, and a stretch of a long run needs one or two groups of
/// 5 km at 60 m/s. With fewer rows, dictionaries and footers take a larger share of the file.
const GROUP: usize = 1 << 14;
/// Level of compression: higher levels save some percent of the size and take several times as long.
const LEVEL: i32 = 3;

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
}

/// A column as it is in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct FileColumn {
    /// `name [unit]`, as in the header of a text.
    pub heading: String,
    pub values: Values,
    /// How its numbers are written in a text, if all are written alike. It is in the metadata of the field.
    pub digits: Option<Digits>,
}

/// The bytes of a Parquet file.
///
/// # Errors
/// `write-failed`: columns of different length, or two of the same name.
pub fn parquet(columns: Vec<FileColumn>) -> Result<Vec<u8>, Problem> {
    let failed = |error: &dyn std::fmt::Display| Problem::error("write-failed", format!("a record cannot be written as Parquet: {error}"));
    let mut fields = Vec::new();
    let mut arrays: Vec<ArrayRef> = Vec::new();
    for column in columns {
        let (kind, array): (_, ArrayRef) = match column.values {
            Values::Numbers(values) => (DataType::Float64, Arc::new(Float64Array::from(values))),
            Values::Texts(texts) => (DataType::Utf8, Arc::new(StringArray::from(texts))),
        };
        let metadata = column.digits.map(Digits::metadata).map(|(key, value)| (key.to_string(), value));
        fields.push(Field::new(column.heading, kind, false).with_metadata(metadata.into_iter().collect::<HashMap<_, _>>()));
        arrays.push(array);
    }
    let schema = Arc::new(Schema::new(fields));
    let batch = RecordBatch::try_new(Arc::clone(&schema), arrays).map_err(|error| failed(&error))?;
    let mut bytes = Vec::new();
    let properties = properties().map_err(|error| failed(&error))?;
    let mut writer = ArrowWriter::try_new(&mut bytes, schema, Some(properties)).map_err(|error| failed(&error))?;
    writer.write(&batch).map_err(|error| failed(&error))?;
    writer.close().map_err(|error| failed(&error))?;
    Ok(bytes)
}

/// The bytes of a text with the same columns. Numbers have the form of their column, or else the fewest digits that give the same double
/// again.
pub fn csv(columns: &[FileColumn]) -> Vec<u8> {
    let rows = columns.iter().map(|column| column.values.len()).max().unwrap_or(0);
    let mut text = table_csv(&[columns.iter().map(|column| column.heading.as_str()).collect::<Vec<_>>()]);
    for row in 0..rows {
        for (at, column) in columns.iter().enumerate() {
            text.push_str(if at == 0 { "" } else { "," });
            match &column.values {
                Values::Numbers(values) => {
                    text.push_str(&Digits::exact(column.digits, values.get(row).copied().unwrap_or(f64::NAN)));
                }
                Values::Texts(texts) => push_cell(&mut text, texts.get(row).map_or("", String::as_str)),
            }
        }
        text.push('\n');
    }
    text.into_bytes()
}

/// Line breaks cannot stand in a cell of a record: they become blanks.
fn push_cell(text: &mut String, cell: &str) {
    if cell.contains([',', '"', '\n', '\r']) || cell.trim() != cell {
        let _ = write!(text, "\"{}\"", cell.replace('"', "\"\"").replace(['\n', '\r'], " "));
    } else {
        text.push_str(cell);
    }
}

fn properties() -> Result<WriterProperties, parquet::errors::ParquetError> {
    let builder = WriterProperties::builder()
        // Without a version, so that a new one of the library does not change the bytes.
        .set_created_by("fishplate".to_string())
        .set_compression(Compression::ZSTD(ZstdLevel::try_new(LEVEL)?))
        .set_max_row_group_row_count(Some(GROUP))
        // Of row groups: readers skip by them. Those of pages would be as large as some columns.
        .set_statistics_enabled(EnabledStatistics::Chunk);
    Ok(builder.build())
}
