//! Reads records of other systems: text tables, MDF4, MAT, Parquet, Arrow, Excel, TDMS.
//!
//! A reader returns what is in the file: names, units and numbers as they are written. It knows
//! nothing of channels of a protocol, of campaigns and of mappings.
//!
//! | file | content |
//! |---|---|
//! | `mod` | the types, and the choice of the reader |
//! | `format` | the formats; recognition by content; formats that are not read |
//! | `load` | the bytes of a file; limits of memory |
//! | `guard` | files that are damaged, calls of readers of other projects |
//! | `decode` | encodings of texts |
//! | `binary` | bytes within their bounds, and numbers in them |
//! | `text/` | CSV of any dialect, columns of an ASCII export |
//! | `mat/` | MATLAB files |
//! | `mdf4`, `tdms`, `xlsx`, `columnar` | MDF 4, TDMS, Excel, Parquet and Arrow |

#[cfg(feature = "foreign")]
mod binary;
mod columnar;
mod decode;
mod format;
mod guard;
mod load;
#[cfg(feature = "foreign")]
mod mat;
#[cfg(feature = "foreign")]
mod mdf4;
#[cfg(feature = "foreign")]
mod tdms;
mod text;
#[cfg(feature = "foreign")]
mod xlsx;

use std::path::Path;

pub use format::Format;
pub use text::{ClockForm, DateOrder, DecimalMark, Separator};

use bytes::Bytes;

use crate::data::hash::sha256;
use crate::problem::Problem;
use crate::units::{Dimension, Unit};
use crate::yaml::fields;

/// A file of another system.
#[derive(Clone, Debug)]
pub struct File {
    pub format: Format,
    pub tables: Vec<Table>,
    /// What the file says of itself, and what was detected: name and value.
    pub facts: Vec<(String, String)>,
    /// SHA-256 of the bytes of the file.
    pub sha256: String,
}

/// Channels with a common time base: the whole text table, an MDF channel group, a sheet, a struct,
/// a TDMS group.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Empty if the format has one table without a name.
    pub name: String,
    pub channels: Vec<Channel>,
    pub facts: Vec<(String, String)>,
    /// Samples per second in Hz, from facts of the file or from a channel of time with even steps.
    pub rate: Option<f64>,
    /// Time of the first row in ns since 1970, where the file states it beside the rate.
    pub start: Option<i64>,
    /// Number of rows; also known of an outline, which has no values.
    pub rows: usize,
    /// Line, row of the sheet or sample number of the first row, for messages.
    pub first_row: usize,
    /// Columns that are not channels, for example texts: name and reason.
    pub left_out: Vec<(String, String)>,
}

#[derive(Clone, Debug, Default)]
pub struct Channel {
    pub name: String,
    /// As written in the file.
    pub unit: Option<String>,
    /// Another unit that the file states of it, and that is not the same.
    pub other_unit: Option<String>,
    pub comment: Option<String>,
    /// In the unit of the file; NaN where the cell is empty or the sample is marked invalid. A
    /// binary file can hold infinite values.
    pub values: Vec<f64>,
    /// Of time stamps: the first, in ns since 1970 or, of times of the day alone, since midnight.
    /// The values are seconds from it.
    pub since: Option<i64>,
}

/// Nanoseconds of a second.
pub const NANOSECONDS: i64 = 1_000_000_000;

fields! {
    /// What is said of a file; the rest is detected.
    #[derive(Default)]
    pub struct Options: "`{key}`" {
        "form" form: Option<Format>,
        "separator" separator: Option<Separator>,
        "decimal" decimal: Option<DecimalMark>,
        /// A label of the WHATWG encoding standard, such as `windows-1252`.
        "encoding" encoding: Option<String>,
        /// Number of lines before the numbers.
        "header lines" header_lines: Option<usize>,
        /// Line of the names, from 1; in a sheet its row.
        "line of names" names_line: Option<usize>,
        /// Line of the units, from 1; in a sheet its row. 0: there is none.
        "line of units" units_line: Option<usize>,
        /// Beginning of a line that is not read.
        "comment" comment: Option<String>,
        /// Order of day, month and year in time stamps such as 03/04/2026.
        "dates" dates: Option<DateOrder>,
        /// What times of two numbers are, such as 12:01.
        "clock" clock: Option<ClockForm>,
        /// Number of lines that a row goes over.
        "lines per row" lines_per_row: Option<usize>,
    }
}

/// Whether the values are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Want {
    Values,
    Outline,
}

/// Reads a file.
///
/// # Errors
/// `file-missing`, `file-unreadable`, `file-empty`, `file-too-large`; `format-unknown`,
/// `format-not-read`, `format-mislabelled`, `format-damaged`, `too-many-values`; of a text also
/// `encoding`, `dialect`, `no-numbers`, `line-too-long`, `ragged-row`, `not-a-number`,
/// `not-finite`, `not-a-date`, `decimal-comma`, `thousands`, `date-order`, `clock-form`,
/// `header-line`, `wrapped-rows`, `more-problems`.
pub fn read(path: &Path, shown: &str, options: &Options) -> Result<File, Vec<Problem>> {
    read_as(path, shown, options, Want::Values)
}

/// Reads tables, channels, units and facts without values, where the format allows it; other
/// formats are read whole.
///
/// # Errors
/// As [`read`].
pub fn outline(path: &Path, shown: &str, options: &Options) -> Result<File, Vec<Problem>> {
    read_as(path, shown, options, Want::Outline)
}

fn read_as(path: &Path, shown: &str, options: &Options, want: Want) -> Result<File, Vec<Problem>> {
    let bytes = Bytes::from(load::bytes(path, shown)?);
    let format = format::recognised(&bytes, path, shown, options)?;
    let input = Input { bytes: &bytes, shown, options, format, want };
    let mut read = match format {
        Format::Csv | Format::Ascii => text::read(&input)?,
        Format::Parquet => guard::call(&input, columnar::parquet)?,
        Format::Arrow => guard::call(&input, columnar::arrow)?,
        #[cfg(feature = "foreign")]
        Format::Mat => guard::call(&input, mat::read)?,
        #[cfg(feature = "foreign")]
        Format::Mdf4 => guard::call(&input, mdf4::read)?,
        #[cfg(feature = "foreign")]
        Format::Tdms => tdms::read(&input)?,
        #[cfg(feature = "foreign")]
        Format::Xlsx => guard::call(&input, xlsx::read)?,
        #[cfg(not(feature = "foreign"))]
        _ => return Err(format::not_built(format, shown).into()),
    };
    for table in &mut read.tables {
        for channel in &mut table.channels {
            let stated = channel.unit.as_deref();
            let of_name = stated.and_then(|stated| text::unit_of_name(&channel.name, stated));
            channel.other_unit = conflict(stated, of_name).or(channel.other_unit.take());
        }
        table.rows = table
            .rows
            .max(table.channels.iter().map(|channel| channel.values.len()).max().unwrap_or(0));
        table.rate = table.rate.or_else(|| even_rate(&table.channels));
    }
    Ok(File { format, tables: read.tables, facts: read.facts, sha256: sha256(&bytes) })
}

/// What a reader is given.
struct Input<'a> {
    bytes: &'a Bytes,
    /// The name of the file in messages.
    shown: &'a str,
    options: &'a Options,
    format: Format,
    want: Want,
}

impl Input<'_> {
    /// What was read, if there are channels.
    ///
    /// # Errors
    /// `no-numbers`: there is no `what`.
    fn with_channels(&self, read: Read, what: &str) -> Result<Read, Vec<Problem>> {
        if read.tables.iter().any(|table| !table.channels.is_empty()) {
            return Ok(read);
        }
        Err(Problem::error("no-numbers", format!("`{}` has no {what}", self.shown)).into())
    }
}

/// The other one of two units, if both are known and they are not the same.
fn conflict(unit: Option<&str>, other: Option<String>) -> Option<String> {
    let (unit, other) = unit.zip(other)?;
    let known = |text: &str| Unit::parse(text).is_ok();
    (known(unit) && known(&other) && !Unit::same(unit, &other)).then_some(other)
}

/// A text without blanks around it, if there is one.
fn filled(text: &str) -> Option<String> {
    Some(text.trim()).filter(|text| !text.is_empty()).map(str::to_string)
}

/// What a reader returns.
#[derive(Debug, Default)]
struct Read {
    tables: Vec<Table>,
    facts: Vec<(String, String)>,
}

/// Largest deviation of a time from an even grid, as a part of the step. Times rounded to
/// milliseconds at 200 Hz deviate by a tenth.
const EVEN: f64 = 0.2;

/// The step of values that increase evenly; `None` if they do not.
pub fn even_step(values: &[f64]) -> Option<f64> {
    let (first, last) = (*values.first()?, *values.last()?);
    let steps = values.len() - 1;
    let step = (last - first) / steps as f64;
    let even = |(index, value): (usize, &f64)| {
        (value - (first + step * index as f64)).abs() <= EVEN * step
    };
    (steps > 0 && step > 0.0 && values.iter().enumerate().all(even)).then_some(step)
}

/// The rate of the first channel that is in a unit of time and increases in even steps, in Hz.
fn even_rate(channels: &[Channel]) -> Option<f64> {
    channels.iter().find_map(|channel| {
        let unit = Unit::parse(channel.unit.as_deref()?)
            .ok()
            .filter(|unit| unit.dimension == Dimension::TIME)?;
        even_step(&channel.values).map(|step| 1.0 / unit.to_si(step))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_is_that_of_even_times() {
        let channel = |unit: &str, values: &[f64]| {
            vec![Channel { unit: Some(unit.into()), values: values.to_vec(), ..Channel::default() }]
        };
        let rate = even_rate(&channel("s", &[1.0, 1.005, 1.01, 1.015])).expect("even");
        assert!((rate - 200.0).abs() < 1e-9);
        // Rounded to milliseconds at 400 Hz.
        let rate = even_rate(&channel("ms", &[0.0, 2.0, 5.0, 8.0, 10.0])).expect("even");
        assert!((rate - 400.0).abs() < 1e-9);
        assert_eq!(even_rate(&channel("s", &[0.0, 0.1, 0.3])), None);
        assert_eq!(even_rate(&channel("m", &[0.0, 0.1, 0.2])), None);
        assert_eq!(even_rate(&channel("s", &[0.0])), None);
        assert_eq!(even_rate(&channel("s", &[0.0, f64::NAN, 0.2])), None);
    }
}
