//! Records as Parquet files: only the wanted columns are read, row group by row group.
//!
//! | file | content |
//! |---|---|
//! | `mod` | record, headings, place of a sample |
//! | `layout` | what the footer says |
//! | `open` | the file and the wanted columns |
//! | `groups` | the numbers of a row group |
//! | `runs` | long records: block by block, or a stretch of them |
//! | `guard` | declared sizes, checked before the decoder reserves memory for them |

mod groups;
pub(crate) mod guard;
mod layout;
mod open;
mod runs;

use std::path::Path;

pub(super) use groups::{append, wrong};
pub(super) use layout::Layout;
pub(crate) use layout::guarded;
pub(super) use layout::{headings_of, not_numbers};
pub(super) use open::At;
use open::{Opened, Store};
pub(super) use runs::{stream, stretch};

use super::{Column, Known, Origin, Record, Wanted, find_columns};
use crate::data::cells::Heading;
use crate::data::faults::Faults;
use crate::data::hash::sha256;
use crate::data::text::read_plain;
use crate::data::write::{FileColumn, Values};
use crate::problem::Problem;
use crate::source::{Source, Span};
use crate::units::Unit;

/// First and last bytes of each Parquet file.
pub(super) const MAGIC: &[u8; 4] = b"PAR1";

/// Reads the wanted columns of a record.
pub(super) fn read(at: At<'_>, shown: &str, wanted: &[Wanted]) -> Result<Record, Vec<Problem>> {
    let one = |problem: Problem| vec![problem];
    let (mut opened, hash, from) = match at {
        At::Disk(path) => {
            let mut bytes = Vec::new();
            read_plain(path, shown, &mut bytes).map_err(one)?;
            let hash = sha256(&bytes);
            let opened = Opened::open(Store::memory(bytes), shown).map_err(one)?;
            (opened, hash, Origin::File(path.to_path_buf()))
        }
        At::Object(stored) => {
            let (opened, hash) =
                runs::open_object(stored, shown, &Known::default()).map_err(one)?;
            (opened, hash, Origin::Object(stored.clone()))
        }
    };
    let size = usize::try_from(opened.store.size()).unwrap_or(usize::MAX);
    let mut columns = opened.find(wanted)?;
    let rows = opened.layout.rows();
    if rows == 0 {
        return Err(vec![no_rows(shown)]);
    }
    opened
        .within((rows as u64).saturating_mul(8 * columns.len() as u64), "the record")
        .map_err(one)?;
    for column in &mut columns {
        column.values.reserve_exact(rows);
    }
    let mut faults = Faults::new(shown);
    for group in 0..opened.layout.groups() {
        opened.group(group, &mut columns, &mut faults, &mut |_, _| {}).map_err(one)?;
    }
    faults.finish(())?;
    Ok(Record {
        shown: shown.to_string(),
        columns,
        channels: opened.layout.headings().iter().map(|heading| heading.name.clone()).collect(),
        rows,
        first_row: 0,
        sha256: hash,
        bytes: size,
        from,
    })
}

pub(super) fn no_rows(shown: &str) -> Problem {
    Problem::error("no-rows", format!("`{shown}` has columns and no samples"))
}

/// Every column as it is in the file: numbers in the unit of the file, or texts.
pub(super) fn raw(path: &Path, shown: &str) -> Result<Vec<FileColumn>, Vec<Problem>> {
    let one = |problem: Problem| vec![problem];
    let mut opened = open_file(At::Disk(path), shown)?;
    let headings = opened.layout.headings().to_vec();
    opened
        .within(
            (opened.layout.rows() as u64).saturating_mul(8 * headings.len() as u64),
            "the record",
        )
        .map_err(one)?;
    let mut columns = Vec::new();
    for (position, heading) in headings.iter().enumerate() {
        let mut column = [Column {
            name: heading.name.clone(),
            unit: Unit::one(),
            values: Vec::new(),
            position,
        }];
        if let Some(problem) = opened.other_codec(&column[0]) {
            return Err(one(problem));
        }
        let values = if opened.layout.is_text(position) {
            Values::Texts(opened.texts(&column[0]).map_err(one)?)
        } else {
            if let Some(problem) = opened.not_numbers(&column[0]) {
                return Err(one(problem));
            }
            let mut faults = Faults::new(shown);
            for group in 0..opened.layout.groups() {
                opened.group(group, &mut column, &mut faults, &mut |_, _| {}).map_err(one)?;
            }
            faults.finish(())?;
            let [column] = column;
            Values::Numbers(column.values)
        };
        columns.push(FileColumn {
            heading: heading.span.text().to_string(),
            values,
            digits: opened.layout.digits(position),
        });
    }
    Ok(columns)
}

/// The headings of a record.
pub(super) fn headings(at: At<'_>, shown: &str) -> Result<Vec<Heading>, Vec<Problem>> {
    let opened = open_file(at, shown)?;
    Ok(opened.layout.headings().to_vec())
}

fn open_file<'a>(at: At<'_>, shown: &'a str) -> Result<Opened<'a>, Vec<Problem>> {
    Store::at(at, shown)
        .and_then(|store| Opened::open(store, shown))
        .map_err(|problem| vec![problem])
}

/// The place of a sample, from 0, or of its value in a column.
pub(super) fn place(at: At<'_>, shown: &str, row: usize, column: Option<&Column>) -> Option<Span> {
    let Some(column) = column else {
        return Some(Source::excerpt(shown, format!("row {}", row + 1), row + 1).whole());
    };
    let mut opened = open_file(at, shown).ok()?;
    let (group, first) = opened.layout.group_of(row)?;
    let mut one = [Column { values: Vec::new(), ..column.clone() }];
    let mut faults = Faults::new(shown);
    opened.group(group, &mut one, &mut faults, &mut |_, _| {}).ok()?;
    let value = column.unit.from_si(*one[0].values.get(row - first)?);
    Some(value_at(shown, &opened.layout.headings()[column.position], row, &value.to_string()))
}

/// A Parquet file has no text: the place shows `name [unit] = value`, in the line with the number
/// of the row, from 1.
pub(super) fn value_at(shown: &str, heading: &Heading, row: usize, value: &str) -> Span {
    let name = format!("{} = ", heading.span.text());
    let from = name.len();
    let text = name + value;
    let end = text.len();
    Source::excerpt(shown, text, row + 1).span(from..end)
}

#[cfg(test)]
mod tests;
