//! Reads a file of values: first its seal, then which program wrote it, then its contents.

use std::{error::Error, path::Path};

use arrow_array::RecordBatch;
use bytes::Bytes;
use parquet::arrow::{ProjectionMask, arrow_reader::ParquetRecordBatchReaderBuilder};
use serde::de::DeserializeOwned;

use super::{
    FORM, Head, PROGRAM,
    rows::OWN,
    seal::{self, Broken, Budget},
    write,
};
use crate::data::{
    record::{guard, guarded},
    text::read_file,
};
use crate::problem::{Problem, problem};
use crate::run::{Kept, Numbered};

/// Maximum size of a file in bytes. The values of 100 km take 2 MB.
const LARGEST: u64 = 4 << 30;
/// Rows of the table that are read at a time.
const ROWS: usize = 1024;
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
    let no_values = |says| {
        let help = "give files that `fishplate reduce` wrote";
        Err(problem!("values-unreadable", "`{shown}` is {says}").help(help))
    };
    if !bytes.starts_with(MAGIC) {
        return no_values("not a file of values");
    }
    let hash = match seal::check(&bytes) {
        Ok(hash) => hash,
        Err(Broken::NoSeal) if bytes.ends_with(MAGIC) => {
            return no_values("a Parquet file, but not one of values");
        }
        Err(broken) => {
            let how = match broken {
                Broken::NoSeal => "is not complete",
                Broken::Changed => "is not as it was written: its SHA-256 differs",
            };
            return Err(problem!("values-damaged", "`{shown}` {how}").help(AGAIN));
        }
    };
    let unreadable =
        |why| problem!("values-unreadable", "`{shown}` is not a file of values: {why}").help(AGAIN);
    let contents = guarded(|| contents(bytes)).map_err(unreadable)?;
    let (head, table, sections, traces) = contents.map_err(|OtherVersion { file, own }| {
        problem!("values-version", "`{shown}` was written by fishplate {file}, this is {own}")
            .help("values are judged by the version that computed them: make it again")
    })?;
    Ok(File { shown: shown.to_string(), hash, head, table, sections, traces })
}

/// The versions of a file and of this program, with the form of the values where only that differs.
struct OtherVersion {
    file: String,
    own: String,
}

type Contents = (Head, Vec<RecordBatch>, Vec<Numbered>, Vec<Kept>);

fn contents(bytes: Vec<u8>) -> Result<Result<Contents, OtherVersion>, Box<dyn Error>> {
    let (mut budget, bytes) = (Budget::of(bytes.len()), Bytes::from(bytes));
    guard::footer_of(&bytes)?;
    let builder = ParquetRecordBatchReaderBuilder::try_new(bytes.clone())?;
    let entries =
        builder.metadata().file_metadata().key_value_metadata().cloned().unwrap_or_default();
    let text = |key: &str| {
        let entry = entries.iter().find(|entry| entry.key == key);
        let text = entry.and_then(|entry| entry.value.as_deref());
        text.ok_or_else(|| format!("it has no `{key}`"))
    };
    let about: serde_json::Value = serde_json::from_str(text(write::ABOUT)?)?;
    let program = about["program"].as_str().unwrap_or("of an unknown version");
    if program != PROGRAM || about["form"] != FORM {
        let form = |form: &serde_json::Value| {
            if program == PROGRAM { format!(" with values of form {form}") } else { String::new() }
        };
        let file = format!("{program}{}", form(&about["form"]));
        return Ok(Err(OtherVersion { file, own: format!("{PROGRAM}{}", form(&FORM.into())) }));
    }
    let head: Head = json(text(write::HEAD)?, &mut budget)?;
    let mut sections: Vec<Numbered> = json(text(write::SECTIONS)?, &mut budget)?;
    let traces: Vec<Kept> = json(text(write::TRACES)?, &mut budget)?;
    let sections_of_head = head.basis.units().len();
    if let Some((number, _)) = sections.iter().find(|(number, _)| *number >= sections_of_head) {
        return Err(format!("it has a section number {number} of {sections_of_head}").into());
    }
    if traces.iter().any(|kept| !kept.is_sound()) {
        return Err("the signals of a plot differ in length".into());
    }
    marks(&budget.unpacked(text(write::MARKS)?)?, &mut sections)?;
    let own = ProjectionMask::columns(builder.parquet_schema(), OWN);
    // A page with one long text can stand for many rows.
    let page = guard::all_pages(&bytes, builder.metadata())?.max(1);
    let rows = usize::try_from(budget.left() / page)?.clamp(1, ROWS);
    let mut table = Vec::new();
    for batch in builder.with_projection(own).with_batch_size(rows).build()? {
        let batch = batch?;
        budget.take(batch.get_array_memory_size() as u64)?;
        table.push(batch);
    }
    Ok(Ok((head, table, sections, traces)))
}

fn json<T: DeserializeOwned>(text: &str, budget: &mut Budget) -> Result<T, String> {
    serde_json::from_slice(&budget.unpacked(text)?).map_err(|error| error.to_string())
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
