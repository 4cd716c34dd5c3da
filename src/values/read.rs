//! Reads a file of values: first its seal, then which program wrote it, then its contents.

use std::path::Path;

use arrow_array::RecordBatch;
use bytes::Bytes;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use serde::de::DeserializeOwned;

use super::rows::OWN;
use super::seal::{self, Broken};
use super::{FORM, Head, PROGRAM, write};
use crate::data::record::guarded;
use crate::data::text::read_file;
use crate::problem::Problem;
use crate::run::{Kept, Numbered};

/// Maximum size of a file in bytes. The values of 100 km take 2 MB.
const LARGEST: u64 = 4 << 30;
/// At both ends of a Parquet file.
const MAGIC: &[u8] = b"PAR1";

/// A file that was read, of which the rows are not yet those of a protocol.
#[derive(Clone, Debug)]
pub struct File {
    /// Name as given by the user.
    pub shown: String,
    /// Of its contents.
    pub hash: String,
    pub head: Head,
    /// The table, batch by batch.
    pub(super) table: Vec<RecordBatch>,
    pub(super) sections: Vec<Numbered>,
    pub(super) traces: Vec<Kept>,
}

/// Opens a file of values.
///
/// # Errors
/// As [`read`] and [`read_file`].
pub fn open(path: &Path) -> Result<File, Problem> {
    let shown = path.display().to_string();
    let bytes = read_file(path, &shown, LARGEST)?;
    read(&shown, bytes)
}

/// Reads the bytes of a file of values.
///
/// # Errors
/// `values-unreadable`, `values-damaged`, `values-version`.
pub fn read(shown: &str, bytes: Vec<u8>) -> Result<File, Problem> {
    const AGAIN: &str = "make it again with `fishplate reduce`, or copy it again";
    if !bytes.starts_with(MAGIC) {
        let says = format!("`{shown}` is not a file of values");
        return Err(Problem::error("values-unreadable", says)
            .help("give files that `fishplate reduce` wrote"));
    }
    let hash = match seal::check(&bytes) {
        Ok(hash) => hash,
        Err(Broken::NoSeal) if bytes.ends_with(MAGIC) => {
            let says = format!("`{shown}` is a Parquet file, but not one of values");
            return Err(Problem::error("values-unreadable", says)
                .help("give files that `fishplate reduce` wrote"));
        }
        Err(broken) => {
            let how = if broken == Broken::NoSeal {
                "is not complete"
            } else {
                "is not as it was written: its SHA-256 differs"
            };
            return Err(Problem::error("values-damaged", format!("`{shown}` {how}")).help(AGAIN));
        }
    };
    let contents =
        guarded(|| Ok(contents(bytes))).unwrap_or_else(|why| Err(Why::Unreadable(why.to_string())));
    let (head, table, sections, traces) = contents.map_err(|why| match why {
        Why::Version(other, form) => {
            let says =
                format!("`{shown}` was written by fishplate {other}, this is {PROGRAM}{form}");
            Problem::error("values-version", says)
                .help("values are judged by the version that computed them: make it again")
        }
        Why::Unreadable(why) => {
            Problem::error("values-unreadable", format!("`{shown}` is not a file of values: {why}"))
                .help(AGAIN)
        }
    })?;
    Ok(File { shown: shown.to_string(), hash, head, table, sections, traces })
}

enum Why {
    /// Of the file, and what is added to that of this program.
    Version(String, String),
    Unreadable(String),
}

impl From<String> for Why {
    fn from(why: String) -> Self {
        Self::Unreadable(why)
    }
}

type Contents = (Head, Vec<RecordBatch>, Vec<Numbered>, Vec<Kept>);

fn contents(bytes: Vec<u8>) -> Result<Contents, Why> {
    let builder = ParquetRecordBatchReaderBuilder::try_new(Bytes::from(bytes))
        .map_err(|error| error.to_string())?;
    let entries =
        builder.metadata().file_metadata().key_value_metadata().cloned().unwrap_or_default();
    let text = |key: &str| {
        let found =
            entries.iter().find(|entry| entry.key == key).and_then(|entry| entry.value.as_deref());
        found.ok_or_else(|| format!("it has no `{key}`"))
    };
    let about: serde_json::Value =
        serde_json::from_str(text(write::ABOUT)?).map_err(|error| error.to_string())?;
    let program = about["program"].as_str().unwrap_or("of an unknown version");
    if program != PROGRAM || about["form"] != FORM {
        let form = |form: &serde_json::Value| {
            if program == PROGRAM { format!(" with values of form {form}") } else { String::new() }
        };
        return Err(Why::Version(format!("{program}{}", form(&about["form"])), form(&FORM.into())));
    }
    let head: Head = json(text(write::HEAD)?)?;
    let mut sections: Vec<Numbered> = json(text(write::SECTIONS)?)?;
    let traces: Vec<Kept> = json(text(write::TRACES)?)?;
    let sections_of_head = head.basis.units().len();
    if let Some((number, _)) = sections.iter().find(|(number, _)| *number >= sections_of_head) {
        return Err(format!("it has a section number {number} of {sections_of_head}").into());
    }
    if traces.iter().any(|kept| !kept.is_sound()) {
        return Err("the signals of a plot differ in length".to_string().into());
    }
    marks(&seal::unpacked(text(write::MARKS)?)?, &mut sections)?;
    let own = ProjectionMask::columns(builder.parquet_schema(), OWN);
    let table = builder
        .with_projection(own)
        .build()
        .and_then(|reader| reader.map(|batch| Ok(batch?)).collect());
    Ok((head, table.map_err(|error| error.to_string())?, sections, traces))
}

fn json<T: DeserializeOwned>(text: &str) -> Result<T, String> {
    serde_json::from_slice(&seal::unpacked(text)?).map_err(|error| error.to_string())
}

/// Puts the marks of signals to their prints.
fn marks(bytes: &[u8], sections: &mut [Numbered]) -> Result<(), String> {
    let numbers: Vec<u32> =
        bytes.as_chunks().0.iter().map(|four| u32::from_le_bytes(*four)).collect();
    let mut left = numbers.as_slice();
    for print in sections.iter_mut().flat_map(|(_, of_section)| &mut of_section.prints) {
        let ends = || "the marks of its signals end too early".to_string();
        let (count, rest) = left.split_first().ok_or_else(ends)?;
        let count =
            usize::try_from(*count).ok().filter(|count| *count <= rest.len()).ok_or_else(ends)?;
        print.marks = rest[..count].to_vec();
        left = &rest[count..];
    }
    Ok(())
}
