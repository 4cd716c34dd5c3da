//! What the footer of a Parquet file says: columns with names and units, and row groups.

use std::{error::Error, ops::Range, panic::AssertUnwindSafe, sync::Arc};

use arrow_schema::{DataType, Schema};
use bytes::Bytes;
use parquet::{
    arrow::{
        arrow_reader::{ArrowReaderMetadata, ArrowReaderOptions},
        parquet_to_arrow_schema,
    },
    file::metadata::{ColumnChunkMetaData, ParquetMetaData, ParquetMetaDataReader},
};

use super::guard;
use crate::data::{
    cells::{Heading, duplicates, name_and_unit, shortened},
    checksum::{self, Sums},
    prelude::*,
    write::Digits,
};

/// Key of the metadata of a field that holds its unit.
const UNIT_KEY: &str = "unit";

/// What the footer says. Stretches of one file share it.
#[derive(Debug)]
pub struct Layout {
    pub metadata: ArrowReaderMetadata,
    pub fields: Vec<Field>,
    pub headings: Vec<Heading>,
    /// Row before the first one of each group, and the number of rows of the file.
    starts: Vec<usize>,
    /// Of a file that this program wrote.
    sums: Sums,
}

impl Layout {
    pub fn read(footer: &Bytes, shown: &str) -> Result<Self, Problem> {
        guard::footer(footer).map_err(|why| damaged(shown, &format!("its footer: {why}")))?;
        let parsed = guarded(|| {
            let metadata = ParquetMetaDataReader::decode_metadata(footer)?;
            let file = metadata.file_metadata();
            // The schema that Arrow adds has the metadata of the fields. Values are decoded by the
            // types of Parquet.
            let described =
                parquet_to_arrow_schema(file.schema_descr(), file.key_value_metadata())?;
            let options = ArrowReaderOptions::new().with_skip_arrow_metadata(true);
            Ok((ArrowReaderMetadata::try_new(Arc::new(metadata), options)?, described))
        });
        let (metadata, described) = parsed.map_err(|why| damaged(shown, &why))?;
        let starts = starts(metadata.metadata(), shown)?;
        let headings = headings_of(metadata.schema(), &described, shown)?;
        let sums = sums(footer, metadata.metadata()).ok_or_else(|| {
            damaged(shown, "its footer is not the one that was written (checksum)")
        })?;
        Ok(Self { fields: fields(&metadata, &described), metadata, headings, starts, sums })
    }

    pub fn rows(&self) -> usize {
        self.starts.last().copied().unwrap_or(0)
    }

    /// The rows of each group.
    pub fn groups(&self) -> Vec<Range<usize>> {
        self.starts.windows(2).map(|ends| ends[0]..ends[1]).collect()
    }

    /// The group of a row of the file.
    pub fn group_of(&self, row: usize) -> usize {
        self.starts.partition_point(|start| *start <= row).saturating_sub(1)
    }

    /// The values of a column in a group, as they are declared; none of a column of lists or
    /// structures.
    pub fn chunk(&self, group: usize, position: usize) -> Option<&ColumnChunkMetaData> {
        Some(self.metadata.metadata().row_group(group).column(self.fields.get(position)?.leaf?))
    }

    /// Whether these bytes of a column in a group are those that were written, as far as the file
    /// says so.
    pub fn is_sound(&self, group: usize, position: usize, bytes: &[u8]) -> bool {
        let leaf = self.fields.get(position).and_then(|field| field.leaf).unwrap_or_default();
        let columns = self.metadata.parquet_schema().num_columns();
        self.sums.holds(group * columns + leaf, bytes)
    }
}

/// The checksums that the file states of its parts; `None` if its footer is not as it was written.
fn sums(footer: &[u8], metadata: &ParquetMetaData) -> Option<Sums> {
    let file = metadata.file_metadata();
    // Wherever it stands: a changed byte may be one that says where.
    if memchr::memmem::find(footer, checksum::WRITER.as_bytes()).is_none() {
        return Some(Sums::default());
    }
    let mut entries = file.key_value_metadata().into_iter().flatten();
    let entry = entries.find(|entry| entry.key == checksum::KEY)?;
    checksum::is_sound(footer).then(|| Sums::of_entry(entry.value.as_deref().unwrap_or_default()))
}

/// A column of the file.
#[derive(Debug)]
pub struct Field {
    /// Index among the columns that hold values; absent for a column of lists or structures.
    pub leaf: Option<usize>,
    pub kind: DataType,
    /// How its numbers are written in a text.
    pub digits: Option<Digits>,
}

/// A problem for a column that does not hold numbers.
pub fn not_numbers(kind: &DataType, name: &str, at: &Span) -> Option<Problem> {
    let what = match kind {
        DataType::Float16 | DataType::Float32 | DataType::Float64 => return None,
        kind if kind.is_integer() => return None,
        DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View => "text",
        DataType::Binary
        | DataType::LargeBinary
        | DataType::BinaryView
        | DataType::FixedSizeBinary(_) => "bytes",
        DataType::Boolean => "truth values",
        DataType::Duration(_) => "durations, whose unit is not that of a column",
        DataType::Timestamp(..)
        | DataType::Date32
        | DataType::Date64
        | DataType::Time32(_)
        | DataType::Time64(_) => "dates or times of day",
        kind if kind.is_nested() => "lists or structures",
        kind if kind.is_decimal() => "decimal numbers of fixed point",
        _ => "no numbers",
    };
    let says = format!(
        "the column `{name}` holds {what} (row 1); floating-point numbers or integers are needed"
    );
    Some(error("not-a-number", says, at))
}

/// Rows before each group, and all rows. A flat column has a value for each row.
fn starts(metadata: &ParquetMetaData, shown: &str) -> Result<Vec<usize>, Problem> {
    let mut starts = vec![0_usize];
    let mut before = 0_usize;
    for (number, group) in metadata.row_groups().iter().enumerate() {
        let (number, rows) = (number + 1, group.num_rows());
        let all = usize::try_from(rows).ok().and_then(|rows| before.checked_add(rows));
        before = all
            .filter(|all| isize::try_from(*all).is_ok())
            .ok_or_else(|| damaged(shown, &format!("row group {number} has {rows} rows")))?;
        for column in group.columns() {
            let (descriptor, values) = (column.column_descr(), column.num_values());
            if descriptor.max_rep_level() == 0 && values != rows {
                let name = descriptor.name();
                let why = format!(
                    "row group {number}: the column `{name}` has {values} values in {rows} rows"
                );
                return Err(damaged(shown, &why));
            }
        }
        starts.push(before);
    }
    Ok(starts)
}

fn fields(metadata: &ArrowReaderMetadata, described: &Schema) -> Vec<Field> {
    let schema = metadata.parquet_schema();
    let leaf = |position: usize| {
        let leaf =
            (0..schema.num_columns()).find(|leaf| schema.get_column_root_idx(*leaf) == position)?;
        let flat = schema.root_schema().get_fields().get(position)?.is_primitive();
        (flat && schema.column(leaf).max_rep_level() == 0).then_some(leaf)
    };
    let field = |(position, field): (usize, &Arc<arrow_schema::Field>)| {
        let described = described.fields().get(position);
        // Durations are whole numbers for Parquet; only the schema that Arrow adds says of what.
        let duration = described.filter(|told| matches!(told.data_type(), DataType::Duration(_)));
        let told = |key: &str| described?.metadata().get(key).map(String::as_str);
        Field {
            leaf: leaf(position),
            kind: duration.unwrap_or(field).data_type().clone(),
            digits: Digits::read(told),
        }
    };
    metadata.schema().fields().iter().enumerate().map(field).collect()
}

/// The headings, as if they were the header line of a text.
pub fn headings_of(
    schema: &Schema,
    described: &Schema,
    shown: &str,
) -> Result<Vec<Heading>, Problem> {
    let mut line = String::new();
    let mut places: Vec<Range<usize>> = Vec::new();
    let mut conflict = None;
    for (at, field) in schema.fields().iter().enumerate() {
        let told = described.fields().get(at).and_then(|field| field.metadata().get(UNIT_KEY));
        let told = told.map(|unit| unit.trim()).filter(|unit| !unit.is_empty());
        let written: String =
            field.name().chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        let written = written.trim();
        line.push_str(if at == 0 { "" } else { ", " });
        let from = line.len();
        line.push_str(written);
        match (name_and_unit(written).1, told) {
            (Some(range), Some(told)) if !Unit::same(&written[range.clone()], told) => {
                conflict = conflict.or(Some((at, told.to_string())));
            }
            (None, Some(told)) => line += &format!(" [{told}]"),
            _ => {}
        }
        places.push(from..line.len());
    }
    let source = Source::new(shown, line);
    let heading = |place| {
        let span = source.span(place);
        Heading::read(span.text(), span.clone())
    };
    let headings: Vec<Heading> = places.into_iter().map(heading).collect();
    if let Some((at, told)) = conflict {
        let Heading { name, unit, span } = &headings[at];
        let written = unit.as_ref().map_or("", |unit| unit.text.as_str());
        return Err(problem!(
            "unit-conflict",
            span,
            "the column `{name}` is in {written} by its name and in {} by its metadata",
            shortened(&told)
        )
        .help("keep one of them, or make both the same"));
    }
    duplicates(&headings).into_iter().next().map_or(Ok(headings), Err)
}

pub fn damaged(shown: &str, why: &str) -> Problem {
    const MOST: usize = 200;
    // The first line: some reasons of the decoder have several.
    let line = why.lines().next().unwrap_or_default();
    let why: String = line.chars().filter(|c| !c.is_control()).take(MOST).collect();
    let why = why.trim_start_matches("Parquet error: ");
    problem!("file-damaged", "`{shown}` cannot be read as Parquet: {why}")
        .help("the file may have been cut off or changed; export or copy it again")
}

thread_local! {
    /// Whether a panic of this thread is caught and told as a problem.
    static CAUGHT: std::cell::Cell<bool> = const { std::cell::Cell::new(false) };
}

/// Runs the decoder. It checks its input in most places but asserts in some, so that a damaged file
/// can make it panic: this becomes an error like any other, and the message of the panic is not
/// printed.
pub(crate) fn guarded<T>(run: impl FnOnce() -> Result<T, Box<dyn Error>>) -> Result<T, String> {
    static QUIET: std::sync::Once = std::sync::Once::new();
    QUIET.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if !CAUGHT.get() {
                before(info);
            }
        }));
    });
    CAUGHT.set(true);
    let done = std::panic::catch_unwind(AssertUnwindSafe(run));
    CAUGHT.set(false);
    match done {
        Ok(done) => done.map_err(|why| why.to_string()),
        Err(_) => Err("its content contradicts itself".into()),
    }
}
