//! A Parquet file: its footer, its columns with names and units, and the bytes of its parts.

use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;
use std::panic::AssertUnwindSafe;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow_schema::{DataType, Schema};
use bytes::Bytes;
use parquet::arrow::arrow_reader::{ArrowReaderMetadata, ArrowReaderOptions};
use parquet::arrow::parquet_to_arrow_schema;
use parquet::arrow::push_decoder::PushBuffers;
use parquet::basic::Compression;
use parquet::file::metadata::{ParquetMetaData, ParquetMetaDataReader};
use parquet::file::reader::ChunkReader;

use super::{Column, Heading, MAGIC, Wanted, find_columns, guard};
use crate::data::cells::{HeadingUnit, duplicates, name_and_unit, shortened};
use crate::data::record::Stored;
use crate::data::record::held::Held;
use crate::data::text::{LARGEST_RECORD, plain_size, unreadable};
use crate::data::write::Digits;
use crate::disk;
use crate::problem::Problem;
use crate::source::{Source, Span};
use crate::units::Unit;

/// Maximum size of a footer in bytes: a hundred channels in a thousand row groups take 10 MB.
const LARGEST_FOOTER: u64 = 32 << 20;
/// Bytes after the footer: its length and the magic number.
const TAIL: u64 = 8;
/// Key of the metadata of a field that holds its unit.
const UNIT_KEY: &str = "unit";

/// Most bytes of numbers and pages for a byte of the file, above [`FREE`]: a record of one section has 10 to 50, a column that never
/// changes more. A file of some kilobytes can declare gigabytes.
const MOST_INFLATION: u64 = 1000;
/// Bytes of numbers and pages that any file may need: a page of the maximum size.
const FREE: u64 = guard::LARGEST_PAGE;

/// Where a Parquet file is.
#[derive(Clone, Copy)]
pub(in crate::data::record) enum At<'a> {
    Disk(&'a Path),
    Object(&'a Stored),
}

/// Where the bytes are.
pub(super) enum Store {
    /// The whole file: its parts are used where they lie, without a copy.
    Memory(PushBuffers, u64),
    Disk {
        file: disk::Reader,
        path: PathBuf,
        size: u64,
        /// Where parts are kept that are read again.
        held: Option<Held>,
    },
    Object(Stored),
}

impl Store {
    pub fn at(at: At<'_>, shown: &str) -> Result<Self, Problem> {
        match at {
            At::Disk(path) => Self::disk(path, shown),
            At::Object(stored) => Ok(Self::Object(stored.clone())),
        }
    }

    fn disk(path: &Path, shown: &str) -> Result<Self, Problem> {
        let size = plain_size(path, shown)?;
        let file = disk::open(path).map_err(|error| unreadable(shown, &error))?;
        Ok(Self::Disk { file, path: path.to_path_buf(), size, held: None })
    }

    /// As [`Self::disk`], of a file of which several stretches are read.
    pub fn held(path: &Path, shown: &str, kept: &Held) -> Result<Self, Problem> {
        let mut store = Self::disk(path, shown)?;
        if let Self::Disk { held, .. } = &mut store {
            *held = Some(kept.clone());
        }
        Ok(store)
    }

    pub fn memory(bytes: Vec<u8>) -> Self {
        let size = bytes.len() as u64;
        let mut whole = PushBuffers::default();
        whole.push_range(0..size, bytes.into());
        Self::Memory(whole, size)
    }

    /// What a decoder is given before any part is added.
    pub fn buffers(&self) -> PushBuffers {
        match self {
            Self::Memory(whole, _) => whole.clone(),
            Self::Disk { .. } | Self::Object(_) => PushBuffers::default(),
        }
    }

    /// Adds a part of the file to the buffers of a decoder; `look` sees its bytes.
    pub fn add<T>(
        &mut self,
        range: Range<u64>,
        buffers: &mut PushBuffers,
        shown: &str,
        look: impl FnOnce(&[u8]) -> T,
    ) -> Result<T, Problem> {
        match self {
            Self::Memory(whole, _) => {
                let count = usize::try_from(range.end - range.start).unwrap_or(usize::MAX);
                let bytes = whole.get_bytes(range.start, count).map_err(|error| damaged(shown, &error.to_string()))?;
                Ok(look(&bytes))
            }
            Self::Disk { .. } | Self::Object(_) => {
                let bytes = self.read(range.clone(), shown)?;
                let seen = look(&bytes);
                buffers.push_range(range, bytes);
                Ok(seen)
            }
        }
    }

    pub fn size(&self) -> u64 {
        match self {
            Self::Memory(_, size) => *size,
            Self::Disk { size, .. } => *size,
            Self::Object(stored) => stored.object.size(),
        }
    }

    /// Parts that are read soon: those of an object are asked for together.
    pub fn ahead(&self, ranges: &[Range<u64>], shown: &str) -> Result<(), Problem> {
        let Self::Object(Stored { object, held }) = self else { return Ok(()) };
        let name = Path::new(object.url());
        let lacking: Vec<Range<u64>> = ranges.iter().filter(|range| held.get(name, range).is_none()).cloned().collect();
        let read = object.read(&lacking).map_err(|why| unreadable(shown, &why))?;
        for (range, bytes) in lacking.iter().zip(read) {
            held.keep(name, range.start, bytes);
        }
        Ok(())
    }

    pub fn read(&mut self, range: Range<u64>, shown: &str) -> Result<Bytes, Problem> {
        if range.start > range.end || range.end > self.size() {
            return Err(damaged(shown, "a part of it lies outside the file"));
        }
        let count = usize::try_from(range.end - range.start).map_err(|_| damaged(shown, "a part of it is too large"))?;
        match self {
            Self::Memory(whole, _) => whole.get_bytes(range.start, count).map_err(|error| damaged(shown, &error.to_string())),
            Self::Disk { file, path, held, .. } => {
                if let Some(kept) = held.as_ref().and_then(|held| held.get(path, &range)) {
                    return Ok(kept);
                }
                let mut bytes = vec![0; count];
                let done = file.seek(SeekFrom::Start(range.start)).and_then(|_| file.read_exact(&mut bytes));
                let bytes = done.map(|()| Bytes::from(bytes)).map_err(|error| unreadable(shown, &error))?;
                if let Some(held) = held {
                    held.keep(path, range.start, bytes.clone());
                }
                Ok(bytes)
            }
            Self::Object(Stored { object, held }) => {
                let name = Path::new(object.url());
                if let Some(kept) = held.get(name, &range) {
                    return Ok(kept);
                }
                let read = object.read(std::slice::from_ref(&range)).map_err(|why| unreadable(shown, &why))?;
                let bytes = read.into_iter().next().unwrap_or_default();
                held.keep(name, range.start, bytes.clone());
                Ok(bytes)
            }
        }
    }
}

pub(super) fn damaged(shown: &str, why: &str) -> Problem {
    // The first line: some reasons of the decoder have several.
    let why = shortened_reason(why);
    Problem::error("file-damaged", format!("`{shown}` cannot be read as Parquet: {why}"))
        .help("the file may have been cut off or changed; export or copy it again")
}

fn shortened_reason(why: &str) -> String {
    const MOST: usize = 200;
    let line: String = why.lines().next().unwrap_or_default().chars().filter(|c| !c.is_control()).take(MOST).collect();
    line.trim_start_matches("Parquet error: ").to_string()
}

thread_local! {
    /// Whether a panic of this thread is caught and told as a problem.
    static CAUGHT: std::cell::Cell<bool> = const { std::cell::Cell::new(false) };
}

/// Runs the decoder. It checks its input in most places but asserts in some, so that a damaged file can make it panic: this becomes an
/// error like any other, and the message of the panic is not printed.
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

/// A column of the file.
struct Field {
    /// Index among the columns that hold values; absent for a column of lists or structures.
    leaf: Option<usize>,
    kind: DataType,
}

/// An open file.
pub(super) struct Opened<'a> {
    pub(super) store: Store,
    pub(super) shown: &'a str,
    pub(super) metadata: ArrowReaderMetadata,
    fields: Vec<Field>,
    headings: Vec<Heading>,
    digits: Vec<Option<Digits>>,
    /// Row before the first one of each group, and the number of rows of the file.
    starts: Vec<usize>,
}

impl<'a> Opened<'a> {
    pub fn open(mut store: Store, shown: &'a str) -> Result<Self, Problem> {
        let footer = footer(&mut store, shown)?;
        guard::footer(&footer).map_err(|why| damaged(shown, &format!("its footer: {why}")))?;
        let parsed = guarded(|| {
            let metadata = ParquetMetaDataReader::decode_metadata(&footer).map_err(|error| error.to_string())?;
            let (file, pairs) = (metadata.file_metadata(), metadata.file_metadata().key_value_metadata());
            // The schema that Arrow adds has the metadata of the fields. Values are decoded by the types of Parquet.
            let described = parquet_to_arrow_schema(file.schema_descr(), pairs).map_err(|error| error.to_string())?;
            let options = ArrowReaderOptions::new().with_skip_arrow_metadata(true);
            let metadata = ArrowReaderMetadata::try_new(Arc::new(metadata), options).map_err(|error| error.to_string())?;
            Ok((metadata, described))
        });
        let (metadata, described) = parsed.map_err(|why| damaged(shown, &why))?;
        let starts = starts(metadata.metadata(), shown)?;
        let headings = headings_of(metadata.schema(), &described, shown)?;
        let fields = fields(&metadata);
        let kept = |field: &Arc<arrow_schema::Field>| Digits::read(|key| field.metadata().get(key).map(String::as_str));
        let digits = described.fields().iter().map(kept).collect();
        Ok(Self { store, shown, metadata, fields, headings, digits, starts })
    }

    /// Refuses a part of the file that needs too much memory.
    pub fn within(&self, memory: u64, what: &str) -> Result<(), Problem> {
        let most = LARGEST_RECORD.min(FREE.saturating_add(MOST_INFLATION.saturating_mul(self.store.size())));
        if memory <= most {
            return Ok(());
        }
        let says = format!("{what} of `{}` needs {} MB for the wanted columns; the maximum is {} MB", self.shown, memory >> 20, most >> 20);
        Err(Problem::error("file-too-large", says).help("split the record, or write it with row groups of 10 000 to 100 000 rows"))
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

    /// The wanted columns, which must hold numbers.
    pub fn find(&self, wanted: &[Wanted]) -> Result<Vec<Column>, Vec<Problem>> {
        let columns = find_columns(&self.headings, wanted, self.shown)?;
        let mut problems: Vec<Problem> = columns.iter().filter_map(|column| self.not_numbers(column)).collect();
        problems.extend(columns.iter().find_map(|column| self.other_codec(column)));
        if problems.is_empty() { Ok(columns) } else { Err(problems) }
    }

    /// Whether a column holds texts.
    pub fn is_text(&self, position: usize) -> bool {
        self.fields.get(position).is_some_and(|field| field.kind == DataType::Utf8 && field.leaf.is_some())
    }

    /// How the numbers of a column are written in a text.
    pub fn digits(&self, position: usize) -> Option<Digits> {
        self.digits.get(position).copied().flatten()
    }

    /// A problem for a column that does not hold numbers.
    pub(super) fn not_numbers(&self, column: &Column) -> Option<Problem> {
        let (field, heading) = (self.fields.get(column.position)?, self.headings.get(column.position)?);
        let problem = not_numbers(&field.kind, &column.name, &heading.span)?;
        Some(problem.help("convert the column to float64 where the file is written"))
    }
    /// A problem for a column with a compression that is not read.
    pub(super) fn other_codec(&self, column: &Column) -> Option<Problem> {
        let leaf = self.leaf(column.position)?;
        let codecs = self.metadata.metadata().row_groups().iter().map(|group| group.column(leaf).compression());
        let other =
            codecs.into_iter().find(|codec| !matches!(codec, Compression::UNCOMPRESSED | Compression::SNAPPY | Compression::ZSTD(_)))?;
        let name: String = other.to_string().chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '_').collect();
        let says = format!("the column `{}` is compressed with {name}", column.name);
        let problem = Problem::error("format-not-read", says).at(&self.headings.get(column.position)?.span);
        Some(problem.help("write the file with `zstd` or `snappy`, or without compression"))
    }
}

/// A problem for a column that does not hold numbers.
pub(in crate::data::record) fn not_numbers(kind: &DataType, name: &str, at: &Span) -> Option<Problem> {
    let what = match kind {
        DataType::Float16 | DataType::Float32 | DataType::Float64 => return None,
        kind if kind.is_integer() => return None,
        DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View => "text",
        DataType::Binary | DataType::LargeBinary | DataType::BinaryView | DataType::FixedSizeBinary(_) => "bytes",
        DataType::Boolean => "truth values",
        DataType::Timestamp(..) | DataType::Date32 | DataType::Date64 | DataType::Time32(_) | DataType::Time64(_) => {
            "dates or times of day"
        }
        kind if kind.is_nested() => "lists or structures",
        kind if kind.is_decimal() => "decimal numbers of fixed point",
        _ => "no numbers",
    };
    let says = format!("the column `{}` holds {what} (row 1); floating-point numbers or integers are needed", name);
    Some(Problem::error("not-a-number", says).at(at))
}

/// The bytes of the footer.
pub(super) fn footer(store: &mut Store, shown: &str) -> Result<Bytes, Problem> {
    let size = store.size();
    if size == 0 {
        return Err(Problem::error("file-empty", format!("`{shown}` is empty")));
    }
    let head = store.read(0..size.min(4), shown)?;
    if *head == *b"PARE" {
        let says = format!("`{shown}` is an encrypted Parquet file, which is not read");
        return Err(Problem::error("format-not-read", says).help("export it without encryption"));
    }
    if *head != *MAGIC {
        return Err(mislabelled(&store.read(0..size.min(512), shown)?, shown));
    }
    let tail = store.read(size.saturating_sub(TAIL)..size, shown)?;
    if size < 4 + TAIL || !tail.ends_with(MAGIC) {
        let says = "it does not end as a Parquet file does: its end is missing";
        return Err(damaged(shown, says));
    }
    let length = tail.first_chunk::<4>().map_or(0, |length| u64::from(u32::from_le_bytes(*length)));
    if length > size - 4 - TAIL {
        return Err(damaged(shown, &format!("it declares a footer of {length} bytes in a file of {size}")));
    }
    if length > LARGEST_FOOTER {
        let says = format!("`{shown}` has a footer of {} MB; the maximum is {} MB", length >> 20, LARGEST_FOOTER >> 20);
        return Err(Problem::error("file-too-large", says).help("write fewer columns, or larger row groups"));
    }
    store.read(size - TAIL - length..size - TAIL, shown)
}

fn mislabelled(start: &[u8], shown: &str) -> Problem {
    let line = start.split(|byte| *byte == b'\n').next().unwrap_or_default();
    let text = std::str::from_utf8(line).ok().filter(|line| !line.chars().any(|c| c.is_control() && !matches!(c, '\r' | '\t')));
    let problem = Problem::error("format-mislabelled", format!("`{shown}` is not a Parquet file"));
    match text {
        Some(text) => {
            let line = Source::excerpt(shown, shortened(text.trim_end()), 1).whole();
            problem.at(&line).label("it begins with this text").help("if it is a CSV file, its name must end in `.csv`")
        }
        None => problem.help("its first bytes are not those of Parquet; export it again"),
    }
}

/// Rows before each group, and all rows. A flat column has a value for each row.
fn starts(metadata: &ParquetMetaData, shown: &str) -> Result<Vec<usize>, Problem> {
    let mut starts = vec![0_usize];
    for (number, group) in metadata.row_groups().iter().enumerate() {
        let rows = usize::try_from(group.num_rows()).ok();
        let all = rows.and_then(|rows| starts.last()?.checked_add(rows)).filter(|all| isize::try_from(*all).is_ok());
        let all = all.ok_or_else(|| damaged(shown, &format!("row group {} has {} rows", number + 1, group.num_rows())))?;
        for column in group.columns() {
            let descriptor = column.column_descr();
            if descriptor.max_rep_level() == 0 && column.num_values() != group.num_rows() {
                let counts = format!("{} values in {} rows", column.num_values(), group.num_rows());
                return Err(damaged(shown, &format!("row group {}: the column `{}` has {counts}", number + 1, descriptor.name())));
            }
        }
        starts.push(all);
    }
    Ok(starts)
}

fn fields(metadata: &ArrowReaderMetadata) -> Vec<Field> {
    let schema = metadata.parquet_schema();
    let field = |(position, field): (usize, &Arc<arrow_schema::Field>)| {
        let leaf = (0..schema.num_columns()).find(|leaf| schema.get_column_root_idx(*leaf) == position);
        let flat = schema.root_schema().get_fields().get(position).is_some_and(|root| root.is_primitive());
        let kind = field.data_type().clone();
        Field { leaf: leaf.filter(|leaf| flat && schema.column(*leaf).max_rep_level() == 0), kind }
    };
    metadata.schema().fields().iter().enumerate().map(field).collect()
}

/// The headings, as if they were the header line of a text.
pub(in crate::data::record) fn headings_of(schema: &Schema, described: &Schema, shown: &str) -> Result<Vec<Heading>, Problem> {
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
        let written: String = field.name().chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        let written = written.trim();
        line.push_str(if at == 0 { "" } else { ", " });
        let from = line.len();
        line.push_str(written);
        let (_, mut of_unit) = name_and_unit(written);
        match (&of_unit, told) {
            (Some(range), Some(told)) if !same_unit(&written[range.clone()], told) => conflict = conflict.or(Some((at, told.to_string()))),
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
            let unit =
                part.of_unit.map(|range| HeadingUnit { text: span.text()[range.clone()].trim().to_string(), span: span.part(range) });
            Heading { name, unit, span }
        })
        .collect();
    if let Some((at, told)) = conflict {
        let heading = &headings[at];
        let written = heading.unit.as_ref().map_or("", |unit| unit.text.as_str());
        let says = format!("the column `{}` is in {written} by its name and in {} by its metadata", heading.name, shortened(&told));
        return Err(Problem::error("unit-conflict", says).at(&heading.span).help("keep one of them, or make both the same"));
    }
    match duplicates(&headings).into_iter().next() {
        Some(problem) => Err(problem),
        None => Ok(headings),
    }
}

fn same_unit(a: &str, b: &str) -> bool {
    let parsed = |text: &str| Unit::parse(text.trim()).ok().map(|unit| (unit.dimension, unit.factor));
    a.trim() == b || parsed(a).is_some_and(|a| Some(a) == parsed(b))
}
