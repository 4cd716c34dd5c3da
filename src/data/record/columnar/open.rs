//! An open Parquet file: the bytes of its footer and of its parts, and the wanted columns.

use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow_schema::DataType;
use bytes::Bytes;

use super::{Column, MAGIC, Wanted, find_columns, guard};
use crate::data::prelude::*;
use crate::data::{
    cells::shortened,
    faults::Faults,
    record::held::Held,
    record::layout::{Layout, damaged, not_numbers},
    record::stored::Stored,
    text::{LARGEST_RECORD, empty, plain_size, unreadable},
};

/// Maximum size of a footer in bytes: a hundred channels in a thousand row groups take 10 MB.
const LARGEST_FOOTER: u64 = 32 << 20;
/// Bytes after the footer: its length and the magic number.
const TAIL: u64 = 8;

/// Most bytes of numbers and pages for a byte of the file, above [`FREE`]: a record of one section
/// has 10 to 50, a column that never changes more. A file of some kilobytes can declare gigabytes.
const MOST_INFLATION: u64 = 1000;
/// Bytes of numbers and pages that any file may need: a page of the maximum size.
const FREE: u64 = guard::LARGEST_PAGE;

/// Where a Parquet file is.
#[derive(Clone, Copy)]
pub enum At<'a> {
    Disk(&'a Path),
    Object(&'a Stored),
}

/// Where the bytes are.
pub enum Store {
    /// The whole file: its parts are used where they lie, without a copy.
    Memory(Bytes),
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
            At::Disk(path) => Self::disk(path, shown, None),
            At::Object(stored) => Ok(Self::Object(stored.clone())),
        }
    }

    /// A file; of one of which several stretches are read, parts are kept.
    pub fn disk(path: &Path, shown: &str, held: Option<Held>) -> Result<Self, Problem> {
        let size = plain_size(path, shown)?;
        let file = disk::open(path).map_err(unreadable(shown))?;
        Ok(Self::Disk { file, path: path.to_path_buf(), size, held })
    }

    pub fn size(&self) -> u64 {
        match self {
            Self::Memory(bytes) => bytes.len() as u64,
            Self::Disk { size, .. } => *size,
            Self::Object(stored) => stored.object.size(),
        }
    }

    /// The path or the address.
    pub fn name(&self) -> &Path {
        match self {
            Self::Memory(_) => Path::new(""),
            Self::Disk { path, .. } => path,
            Self::Object(stored) => Path::new(stored.object.url()),
        }
    }

    /// Parts that are read soon: those of an object are asked for together.
    pub fn ahead(&self, ranges: &[Range<u64>], shown: &str) -> Result<(), Problem> {
        let Self::Object(Stored { object, held }) = self else { return Ok(()) };
        let name = self.name();
        let lacking: Vec<Range<u64>> =
            ranges.iter().filter(|range| held.get(name, range).is_none()).cloned().collect();
        let read = object.read(&lacking).map_err(unreadable(shown))?;
        lacking.iter().zip(read).for_each(|(range, bytes)| held.keep(name, range.start, bytes));
        Ok(())
    }

    pub fn read(&mut self, range: Range<u64>, shown: &str) -> Result<Bytes, Problem> {
        if range.start > range.end || range.end > self.size() {
            return Err(damaged(shown, "a part of it lies outside the file"));
        }
        let at = |place: u64| {
            usize::try_from(place).map_err(|_| damaged(shown, "a part of it is too large"))
        };
        let held = match self {
            Self::Memory(bytes) => return Ok(bytes.slice(at(range.start)?..at(range.end)?)),
            Self::Disk { held, .. } => held.clone(),
            Self::Object(stored) => Some(stored.held.clone()),
        };
        if let Some(kept) = held.as_ref().and_then(|held| held.get(self.name(), &range)) {
            return Ok(kept);
        }
        let bytes = match self {
            Self::Memory(_) => Bytes::new(),
            Self::Disk { file, .. } => {
                let mut bytes = vec![0; at(range.end - range.start)?];
                file.seek(SeekFrom::Start(range.start))
                    .and_then(|_| file.read_exact(&mut bytes))
                    .map_err(unreadable(shown))?;
                bytes.into()
            }
            Self::Object(stored) => {
                let read = stored.object.read(std::slice::from_ref(&range));
                read.map_err(unreadable(shown))?.into_iter().next().unwrap_or_default()
            }
        };
        if let Some(held) = held {
            held.keep(self.name(), range.start, bytes.clone());
        }
        Ok(bytes)
    }
}

/// An open file.
pub struct Opened<'a> {
    pub store: Store,
    pub shown: &'a str,
    pub layout: Arc<Layout>,
}

impl<'a> Opened<'a> {
    pub fn open(mut store: Store, shown: &'a str) -> Result<Self, Problem> {
        let layout = Arc::new(Layout::read(&footer(&mut store, shown)?, shown)?);
        Ok(Self { store, shown, layout })
    }

    /// As [`Self::open`], of a file whose footer may have been read before.
    pub fn again(store: Store, shown: &'a str, held: &Held) -> Result<Self, Problem> {
        if let Some(layout) = held.layout(store.name()) {
            return Ok(Self { store, shown, layout });
        }
        let opened = Self::open(store, shown)?;
        held.keep_layout(opened.store.name(), &opened.layout);
        Ok(opened)
    }

    /// Appends the numbers of all rows to the columns, in SI units.
    pub fn all_rows(&mut self, columns: &mut [Column]) -> Result<(), Vec<Problem>> {
        let mut faults = Faults::new(self.shown);
        for rows in self.layout.groups() {
            self.rows(rows, columns, &mut faults, &mut |_, _| {})?;
        }
        faults.finish(())
    }

    /// Refuses a record whose numbers in so many columns need too much memory.
    pub fn numbers_within(&self, columns: usize) -> Result<(), Problem> {
        let rows = self.layout.rows() as u64;
        self.within(rows.saturating_mul(8 * columns as u64), "the record")
    }

    /// Refuses a part of the file that needs too much memory.
    pub fn within(&self, memory: u64, what: &str) -> Result<(), Problem> {
        let most = LARGEST_RECORD
            .min(FREE.saturating_add(MOST_INFLATION.saturating_mul(self.store.size())));
        if memory <= most {
            return Ok(());
        }
        Err(problem!(
            "file-too-large",
            "{what} of `{}` needs {} MB for the wanted columns; the maximum is {} MB",
            self.shown,
            memory >> 20,
            most >> 20
        )
        .help("split the record, or write it with row groups of 10 000 to 100 000 rows"))
    }

    /// The wanted columns, which must hold numbers.
    pub fn find(&self, wanted: &[Wanted]) -> Result<Vec<Column>, Vec<Problem>> {
        let columns = find_columns(&self.layout.headings, wanted, self.shown)?;
        let mut problems: Vec<Problem> =
            columns.iter().filter_map(|column| self.not_numbers(column)).collect();
        problems.extend(columns.iter().find_map(|column| self.other_codec(column)));
        if problems.is_empty() { Ok(columns) } else { Err(problems) }
    }

    /// A problem for a column that does not hold numbers.
    pub fn not_numbers(&self, column: &Column) -> Option<Problem> {
        let Layout { fields, headings, .. } = self.layout.as_ref();
        let (kind, at) = (&fields.get(column.position)?.kind, &headings.get(column.position)?.span);
        let problem = not_numbers(kind, &column.name, at)?;
        Some(problem.help("convert the column to float64 where the file is written"))
    }

    /// Whether a column holds texts.
    pub fn is_text(&self, position: usize) -> bool {
        let field = self.layout.fields.get(position);
        field.is_some_and(|field| field.kind == DataType::Utf8 && field.leaf.is_some())
    }

    /// A problem for a column with a compression that is not read.
    pub fn other_codec(&self, column: &Column) -> Option<Problem> {
        let groups = 0..self.layout.groups().len();
        let other = groups
            .filter_map(|group| Some(self.layout.chunk(group, column.position)?.compression()))
            .find(|codec| !guard::is_read(*codec))?;
        let name = guard::codec_name(other);
        let problem = problem!(
            "format-not-read",
            &self.layout.headings.get(column.position)?.span,
            "the column `{}` is compressed with {name}",
            column.name
        );
        Some(problem.help("write the file with `zstd` or `snappy`, or without compression"))
    }
}

/// The bytes of the footer.
pub fn footer(store: &mut Store, shown: &str) -> Result<Bytes, Problem> {
    let size = store.size();
    if size == 0 {
        return Err(empty(shown));
    }
    let head = store.read(0..size.min(4), shown)?;
    if *head == *b"PARE" {
        return Err(problem!(
            "format-not-read",
            "`{shown}` is an encrypted Parquet file, which is not read"
        )
        .help("export it without encryption"));
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
        let says = format!("it declares a footer of {length} bytes in a file of {size}");
        return Err(damaged(shown, &says));
    }
    if length > LARGEST_FOOTER {
        return Err(problem!(
            "file-too-large",
            "`{shown}` has a footer of {} MB; the maximum is {} MB",
            length >> 20,
            LARGEST_FOOTER >> 20
        )
        .help("write fewer columns, or larger row groups"));
    }
    store.read(size - TAIL - length..size - TAIL, shown)
}

fn mislabelled(start: &[u8], shown: &str) -> Problem {
    let problem = problem!("format-mislabelled", "`{shown}` is not a Parquet file");
    let line = start.split(|byte| *byte == b'\n').next().unwrap_or_default();
    let odd = |c: char| c.is_control() && !matches!(c, '\r' | '\t');
    match std::str::from_utf8(line) {
        Ok(text) if !text.contains(odd) => problem
            .at(&Source::excerpt(shown, shortened(text.trim_end()), 1).whole())
            .label("it begins with this text")
            .help("if it is a CSV file, its name must end in `.csv`"),
        _ => problem.help("its first bytes are not those of Parquet; export it again"),
    }
}
