//! Long records: read block by block with bounded memory, or only a stretch of them.

use std::ops::Range;
use std::path::Path;

use super::columnar::{self, At};
use super::indexed;
use super::stretch::{Block, Run, text};
use super::{Format, Known, Record, Wanted};
use crate::problem::Problem;

/// Reads the requested columns of a record of any length, block by block in the order of the file.
/// Memory does not grow with the length of a text; of a Parquet file one row group of these columns
/// is held, compressed.
///
/// # Errors
/// As [`super::read_record`]; reading ends at the first block with a fault, and blocks before it
/// were given to `each`.
pub fn stream(
    path: &Path,
    shown: &str,
    wanted: &[Wanted],
    mut each: impl FnMut(&Block<'_>),
) -> Result<Run, Vec<Problem>> {
    match Format::of(path) {
        Format::Parquet => {
            columnar::stream(At::Disk(path), shown, wanted, &Known::default(), &mut each)
        }
        Format::Csv => text(path, shown, wanted, &mut each),
    }
}

/// As [`stream`]; what [`read_stretch`] needs to know of the file is kept. `axis` is one of the
/// wanted columns.
///
/// # Errors
/// As [`stream`].
pub fn stream_known(
    path: &Path,
    shown: &str,
    wanted: &[Wanted],
    (axis, known): (&str, &Known),
    mut each: impl FnMut(&Block<'_>),
) -> Result<Run, Vec<Problem>> {
    match Format::of(path) {
        Format::Parquet => columnar::stream(At::Disk(path), shown, wanted, known, &mut each),
        Format::Csv => indexed::stream(path, shown, wanted, (axis, known), &mut each),
    }
}

/// Reads the rows of a record whose axis lies in a range, in SI units with both ends, with the hash
/// of the whole file. `axis` is one of the wanted columns; `known` is what is known of the file, if
/// it was read before. Row groups of a Parquet file whose statistics exclude the range are not
/// decoded. A text is read to its end once, for its hash and an index; then only the blocks that
/// touch the range.
///
/// # Errors
/// As [`super::read_record`], of the rows that are decoded; `axis-not-increasing` if rows outside
/// lie between those inside; `outside-record` if none lies inside.
pub fn read_stretch(
    path: &Path,
    shown: &str,
    wanted: &[Wanted],
    axis: &str,
    range: Range<f64>,
    known: &Known,
) -> Result<Record, Vec<Problem>> {
    match Format::of(path) {
        Format::Parquet => columnar::stretch(At::Disk(path), shown, wanted, (axis, &range), known),
        Format::Csv => indexed::stretch(path, shown, wanted, (axis, &range), known),
    }
}
