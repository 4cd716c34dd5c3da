//! What the footer of a Parquet file says: columns with names and units, and row groups.

use std::ops::Range;
use std::panic::AssertUnwindSafe;
use std::sync::Arc;

use arrow_schema::{DataType, Schema};
use bytes::Bytes;
use parquet::arrow::arrow_reader::{ArrowReaderMetadata, ArrowReaderOptions};
use parquet::arrow::parquet_to_arrow_schema;
use parquet::file::metadata::{ParquetMetaData, ParquetMetaDataReader};

use super::{Heading, guard};
use crate::data::cells::{HeadingUnit, duplicates, name_and_unit, shortened};
use crate::data::write::Digits;
use crate::problem::Problem;
use crate::source::{Source, Span};
use crate::units::Unit;

/// Key of the metadata of a field that holds its unit.
const UNIT_KEY: &str = "unit";

/// What the footer says. Stretches of one file share it.
#[derive(Debug)]
pub(in crate::data::record) struct Layout {
    pub(super) metadata: ArrowReaderMetadata,
    pub(super) fields: Vec<Field>,
    headings: Vec<Heading>,
    digits: Vec<Option<Digits>>,
    /// Row before the first one of each group, and the number of rows of the file.
    starts: Vec<usize>,
}

impl Layout {
    pub(super) fn read(footer: &Bytes, shown: &str) -> Result<Self, Problem> {
        guard::footer(footer).map_err(|why| damaged(shown, &format!("its footer: {why}")))?;
        let parsed = guarded(|| {
            let metadata = ParquetMetaDataReader::decode_metadata(footer)
                .map_err(|error| error.to_string())?;
            let (file, pairs) =
                (metadata.file_metadata(), metadata.file_metadata().key_value_metadata());
            // The schema that Arrow adds has the metadata of the fields. Values are decoded by the
            // types of Parquet.
            let described = parquet_to_arrow_schema(file.schema_descr(), pairs)
                .map_err(|error| error.to_string())?;
            let options = ArrowReaderOptions::new().with_skip_arrow_metadata(true);
            let metadata = ArrowReaderMetadata::try_new(Arc::new(metadata), options)
                .map_err(|error| error.to_string())?;
            Ok((metadata, described))
        });
        let (metadata, described) = parsed.map_err(|why| damaged(shown, &why))?;
        let starts = starts(metadata.metadata(), shown)?;
        let headings = headings_of(metadata.schema(), &described, shown)?;
        let fields = fields(&metadata, &described);
        let kept = |field: &Arc<arrow_schema::Field>| {
            Digits::read(|key| field.metadata().get(key).map(String::as_str))
        };
        let digits = described.fields().iter().map(kept).collect();
        Ok(Self { metadata, fields, headings, digits, starts })
    }

    pub fn headings(&self) -> &[Heading] {
        &self.headings
    }

    pub fn rows(&self) -> usize {
        self.starts.last().copied().unwrap_or(0)
    }

    pub fn groups(&self) -> usize {
        self.starts.len() - 1
    }

    /// Rows of a group.
    pub fn rows_of(&self, group: usize) -> Range<usize> {
        self.starts[group]..self.starts[group + 1]
    }

    /// The group of a row, and its first row.
    pub fn group_of(&self, row: usize) -> Option<(usize, usize)> {
        let group = self.starts.partition_point(|start| *start <= row).checked_sub(1)?;
        (row < self.rows()).then(|| (group, self.starts[group]))
    }

    /// Index of a column among those that hold values.
    pub fn leaf(&self, position: usize) -> Option<usize> {
        self.fields.get(position)?.leaf
    }

    /// Whether a column holds texts.
    pub fn is_text(&self, position: usize) -> bool {
        self.fields
            .get(position)
            .is_some_and(|field| field.kind == DataType::Utf8 && field.leaf.is_some())
    }

    /// How the numbers of a column are written in a text.
    pub fn digits(&self, position: usize) -> Option<Digits> {
        self.digits.get(position).copied().flatten()
    }
}

/// A column of the file.
#[derive(Debug)]
pub(super) struct Field {
    /// Index among the columns that hold values; absent for a column of lists or structures.
    leaf: Option<usize>,
    pub kind: DataType,
}

/// A problem for a column that does not hold numbers.
pub(in crate::data::record) fn not_numbers(
    kind: &DataType,
    name: &str,
    at: &Span,
) -> Option<Problem> {
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
        "the column `{}` holds {what} (row 1); floating-point numbers or integers are needed",
        name
    );
    Some(Problem::error("not-a-number", says).at(at))
}

/// Rows before each group, and all rows. A flat column has a value for each row.
fn starts(metadata: &ParquetMetaData, shown: &str) -> Result<Vec<usize>, Problem> {
    let mut starts = vec![0_usize];
    for (number, group) in metadata.row_groups().iter().enumerate() {
        let rows = usize::try_from(group.num_rows()).ok();
        let all = rows
            .and_then(|rows| starts.last()?.checked_add(rows))
            .filter(|all| isize::try_from(*all).is_ok());
        let all = all.ok_or_else(|| {
            damaged(shown, &format!("row group {} has {} rows", number + 1, group.num_rows()))
        })?;
        for column in group.columns() {
            let descriptor = column.column_descr();
            if descriptor.max_rep_level() == 0 && column.num_values() != group.num_rows() {
                let counts = format!("{} values in {} rows", column.num_values(), group.num_rows());
                return Err(damaged(
                    shown,
                    &format!(
                        "row group {}: the column `{}` has {counts}",
                        number + 1,
                        descriptor.name()
                    ),
                ));
            }
        }
        starts.push(all);
    }
    Ok(starts)
}

fn fields(metadata: &ArrowReaderMetadata, described: &Schema) -> Vec<Field> {
    let schema = metadata.parquet_schema();
    let field = |(position, field): (usize, &Arc<arrow_schema::Field>)| {
        let leaf =
            (0..schema.num_columns()).find(|leaf| schema.get_column_root_idx(*leaf) == position);
        let flat =
            schema.root_schema().get_fields().get(position).is_some_and(|root| root.is_primitive());
        // Durations are whole numbers for Parquet; only the schema that Arrow adds says of what.
        let told = described.fields().get(position).map(|field| field.data_type());
        let kind = told
            .filter(|told| matches!(told, DataType::Duration(_)))
            .unwrap_or(field.data_type())
            .clone();
        Field { leaf: leaf.filter(|leaf| flat && schema.column(*leaf).max_rep_level() == 0), kind }
    };
    metadata.schema().fields().iter().enumerate().map(field).collect()
}

/// The headings, as if they were the header line of a text.
pub(in crate::data::record) fn headings_of(
    schema: &Schema,
    described: &Schema,
    shown: &str,
) -> Result<Vec<Heading>, Problem> {
    struct Part {
        from: usize,
        to: usize,
        of_unit: Option<Range<usize>>,
    }
    let mut line = String::new();
    let mut parts: Vec<Part> = Vec::new();
    let mut conflict = None;
    for (at, field) in schema.fields().iter().enumerate() {
        let told = described
            .fields()
            .get(at)
            .and_then(|field| field.metadata().get(UNIT_KEY))
            .map(|unit| unit.trim())
            .filter(|unit| !unit.is_empty());
        let written: String =
            field.name().chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        let written = written.trim();
        line.push_str(if at == 0 { "" } else { ", " });
        let from = line.len();
        line.push_str(written);
        let (_, mut of_unit) = name_and_unit(written);
        match (&of_unit, told) {
            (Some(range), Some(told)) if !same_unit(&written[range.clone()], told) => {
                conflict = conflict.or(Some((at, told.to_string())))
            }
            (None, Some(told)) => {
                line.push_str(" [");
                of_unit = Some(line.len() - from..line.len() - from + told.len());
                line.push_str(told);
                line.push(']');
            }
            _ => {}
        }
        parts.push(Part { from, to: line.len(), of_unit });
    }
    let source = Source::new(shown, line);
    let headings: Vec<Heading> = parts
        .into_iter()
        .map(|part| {
            let span = source.span(part.from..part.to);
            let name = name_and_unit(span.text()).0.to_string();
            let unit = part.of_unit.map(|range| HeadingUnit {
                text: span.text()[range.clone()].trim().to_string(),
                span: span.part(range),
            });
            Heading { name, unit, span }
        })
        .collect();
    if let Some((at, told)) = conflict {
        let heading = &headings[at];
        let written = heading.unit.as_ref().map_or("", |unit| unit.text.as_str());
        let says = format!(
            "the column `{}` is in {written} by its name and in {} by its metadata",
            heading.name,
            shortened(&told)
        );
        return Err(Problem::error("unit-conflict", says)
            .at(&heading.span)
            .help("keep one of them, or make both the same"));
    }
    match duplicates(&headings).into_iter().next() {
        Some(problem) => Err(problem),
        None => Ok(headings),
    }
}

fn same_unit(a: &str, b: &str) -> bool {
    let parsed =
        |text: &str| Unit::parse(text.trim()).ok().map(|unit| (unit.dimension, unit.factor));
    a.trim() == b || parsed(a).is_some_and(|a| Some(a) == parsed(b))
}

pub(super) fn damaged(shown: &str, why: &str) -> Problem {
    // The first line: some reasons of the decoder have several.
    let why = shortened_reason(why);
    Problem::error("file-damaged", format!("`{shown}` cannot be read as Parquet: {why}"))
        .help("the file may have been cut off or changed; export or copy it again")
}

fn shortened_reason(why: &str) -> String {
    const MOST: usize = 200;
    let line: String = why
        .lines()
        .next()
        .unwrap_or_default()
        .chars()
        .filter(|c| !c.is_control())
        .take(MOST)
        .collect();
    line.trim_start_matches("Parquet error: ").to_string()
}

thread_local! {
    /// Whether a panic of this thread is caught and told as a problem.
    static CAUGHT: std::cell::Cell<bool> = const { std::cell::Cell::new(false) };
}

/// Runs the decoder. It checks its input in most places but asserts in some, so that a damaged file
/// can make it panic: this becomes an error like any other, and the message of the panic is not
/// printed.
pub(crate) fn guarded<T>(run: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
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
    done.unwrap_or_else(|_| Err("its content contradicts itself".into()))
}
