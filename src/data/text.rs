//! Reads the text of a file: readable, not empty, UTF-8.

use std::{
    fmt::Display,
    io::{BufRead, BufReader, ErrorKind, Read},
    path::Path,
    sync::Arc,
};

use super::hash::sha256;
use crate::data::prelude::*;

/// Maximum size of a YAML file or table in bytes; typical ones have a few thousand.
const SMALL: u64 = 16 << 20;
/// Maximum size in bytes of a record that is read as a whole, and of its numbers: a hundred
/// channels at 1 kHz for about five minutes. A worker holds its numbers and what is made of them,
/// up to four times as much. Longer records are runs, which are read in parts.
pub const LARGEST_RECORD: u64 = 256 << 20;
/// Maximum length of a line of a record in bytes: ten thousand channels with headings of a hundred
/// characters. A file without lines (zeros, an image, a sparse file) is reported after this number
/// of bytes.
pub const LONGEST_LINE: usize = 1 << 20;
/// Maximum length of a line of a small text in bytes: a table with a thousand columns.
const LONGEST_TEXT_LINE: usize = 64 << 10;
/// Number of bytes of a long line in a message.
const SHOWN: usize = 80;

/// Reads a small text file without its byte order mark, and the SHA-256 of its bytes.
///
/// # Errors
/// `file-missing`, `file-unreadable`, `file-empty`, `file-too-large`, `encoding`.
pub fn read_text(path: &Path, shown: &str) -> Result<(Arc<Source>, String), Problem> {
    text_of(&read_small(path, shown)?, shown)
}

/// The bytes of a small text file.
pub(super) fn read_small(path: &Path, shown: &str) -> Result<Vec<u8>, Problem> {
    read_bytes(path, shown, SMALL)
}

/// As [`read_text`], of bytes in memory.
///
/// # Errors
/// `file-empty`, `file-too-large`, `encoding`, `line-too-long`.
pub fn text_of(bytes: &[u8], shown: &str) -> Result<(Arc<Source>, String), Problem> {
    if bytes.len() as u64 > SMALL {
        return Err(problem!("file-too-large", "`{shown}` has more than {} MB", SMALL >> 20));
    }
    let text = decode(bytes, shown)?;
    if text.trim().is_empty() {
        return Err(empty(shown));
    }
    check_lines(text, shown)?;
    Ok((Source::new(shown, text), sha256(bytes)))
}

/// Refuses a text with an excessively long line, which would be printed with every problem in it.
///
/// # Errors
/// `line-too-long`.
pub fn check_lines(text: &str, shown: &str) -> Result<(), Problem> {
    let Some(at) = text.split('\n').position(|line| line.len() > LONGEST_TEXT_LINE) else {
        return Ok(());
    };
    let (line, most) = (at + 1, LONGEST_TEXT_LINE >> 10);
    Err(problem!("line-too-long", "line {line} of `{shown}` has more than {most} kB")
        .help("break the line, or check whether this is the right file"))
}

/// Reads all bytes of a plain file of any format, which is not empty and not larger than a limit.
///
/// # Errors
/// `file-missing`, `file-unreadable`, `file-empty`, `file-too-large`.
pub fn read_file(path: &Path, shown: &str, limit: u64) -> Result<Vec<u8>, Problem> {
    size(path, shown, limit)?;
    let bytes = disk::read(path, limit).map_err(unreadable(shown))?;
    if bytes.is_empty() { Err(empty(shown)) } else { Ok(bytes) }
}

/// As [`read_file`], of a file that is not of another format by its name.
///
/// # Errors
/// As [`read_file`]; `format-not-read`.
pub fn read_bytes(path: &Path, shown: &str, limit: u64) -> Result<Vec<u8>, Problem> {
    other_format(path, shown).map_or_else(|| read_file(path, shown, limit), Err)
}

/// The size of a record of any length that is not a text.
pub(super) fn plain_size(path: &Path, shown: &str) -> Result<u64, Problem> {
    size(path, shown, u64::MAX)
}

/// Opens a text of any length.
pub(super) fn open_text(path: &Path, shown: &str) -> Result<BufReader<disk::Reader>, Problem> {
    if let Some(problem) = other_format(path, shown) {
        return Err(problem);
    }
    size(path, shown, u64::MAX)?;
    Ok(BufReader::new(disk::open(path).map_err(unreadable(shown))?))
}

/// Reads all bytes of any file of a campaign.
///
/// # Errors
/// As [`read_text`], but for `encoding`; a file may be empty.
pub fn read_any(path: &Path, shown: &str) -> Result<Vec<u8>, Problem> {
    match read_file(path, shown, LARGEST_RECORD) {
        Err(problem) if problem.code == "file-empty" => Ok(Vec::new()),
        read => read,
    }
}

/// A problem for a line that exceeds the maximum length, at its start.
pub(super) fn long_line(start: &[u8], line: usize, shown: &str) -> Problem {
    let start = String::from_utf8_lossy(&start[..start.len().min(SHOWN)]).into_owned();
    problem!(
        "line-too-long",
        &Source::excerpt(shown, start, line).whole(),
        "line {line} of `{shown}` has more than {} MB",
        LONGEST_LINE >> 20
    )
    .help("a record is a text file with one line per sample; export it again")
}

/// Refuses a record that is too large to be read as a whole.
pub(super) fn record_size(path: &Path, shown: &str) -> Result<(), Problem> {
    size(path, shown, LARGEST_RECORD).map(|_| ())
}

/// The first line of an open record file.
pub(super) fn read_line_of(file: &mut impl BufRead, shown: &str) -> Result<Vec<u8>, Problem> {
    let mut line = Vec::new();
    let read = file.take(LONGEST_LINE as u64 + 1).read_until(b'\n', &mut line);
    read.map_err(unreadable(shown))?;
    if line.len() > LONGEST_LINE {
        return Err(long_line(&line, 1, shown));
    }
    if line.is_empty() { Err(empty(shown)) } else { Ok(line) }
}

/// Words of every message about a file or folder that exists but cannot be read.
pub const UNREADABLE: &str = "cannot be read:";

/// Makes the problem of a file or folder that exists but cannot be read, of the reason.
pub(super) fn unreadable<E: Display>(shown: &str) -> impl Fn(E) -> Problem {
    move |why| problem!("file-unreadable", "`{shown}` {UNREADABLE} {why}")
}

/// The size of a plain file that is not larger than a limit.
fn size(path: &Path, shown: &str, limit: u64) -> Result<u64, Problem> {
    match disk::size(path) {
        Err(why) if why.kind() == ErrorKind::NotFound => {
            Err(problem!("file-missing", "there is no file `{shown}`"))
        }
        Ok(size) if size > limit => {
            let (size, most) = (size >> 20, limit >> 20);
            Err(problem!("file-too-large", "`{shown}` has {size} MB; the maximum is {most} MB")
                .help("split it, or leave out channels and samples that are not needed"))
        }
        size => size.map_err(unreadable(shown)),
    }
}

/// File formats of measuring systems and simulation programs that are not supported.
const OTHER_FORMATS: [(&str, &str); 12] = [
    ("mat", "a MATLAB file"),
    ("xlsx", "an Excel workbook"),
    ("xls", "an Excel workbook"),
    ("ods", "a spreadsheet"),
    ("parquet", "a Parquet file"),
    ("feather", "a Feather file"),
    ("mf4", "an ASAM MDF file"),
    ("mdf", "an ASAM MDF file"),
    ("tdms", "a LabVIEW file"),
    ("h5", "an HDF5 file"),
    ("hdf5", "an HDF5 file"),
    ("nc", "a NetCDF file"),
];

/// A problem for a file whose extension is of an unsupported format.
pub(super) fn other_format(path: &Path, shown: &str) -> Option<Problem> {
    let ending = path.extension()?.to_str()?.to_lowercase();
    let (_, what) = OTHER_FORMATS.iter().find(|(known, _)| *known == ending)?;
    Some(problem!("format-not-read", "`{shown}` is {what}; tables are read as CSV, records as CSV or Parquet").help("export it as CSV in UTF-8: one header line `name [unit]`, commas between columns, points in numbers"))
}

pub(super) fn empty(shown: &str) -> Problem {
    problem!("file-empty", "`{shown}` is empty")
}

/// The text of a file without its byte order mark.
///
/// # Errors
/// `encoding`: the name of the encoding if it can be detected, else the first byte that is not
/// UTF-8, with its row.
pub fn decode<'a>(bytes: &'a [u8], shown: &str) -> Result<&'a str, Problem> {
    decode_from(bytes, shown, 1, 0)
}

/// The same of a part of a file that begins with a line, after so many bytes.
pub(super) fn decode_from<'a>(
    bytes: &'a [u8],
    shown: &str,
    first_line: usize,
    before: u64,
) -> Result<&'a str, Problem> {
    const HELP: &str = "save the file as UTF-8";
    let wide = match bytes {
        _ if first_line > 1 => None,
        // Longer marks first: a UTF-32 mark begins like one of UTF-16.
        [0xff, 0xfe, 0, 0, ..] | [0, 0, 0xfe, 0xff, ..] => Some("UTF-32"),
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => Some("UTF-16"),
        // In UTF-16 without a mark, every other byte of Latin text is zero.
        [0, second, 0, fourth, ..] | [second, 0, fourth, 0, ..] if *second != 0 && *fourth != 0 => {
            Some("UTF-16")
        }
        _ => None,
    };
    if let Some(encoding) = wide {
        return Err(problem!("encoding", "`{shown}` is {encoding} text, not UTF-8").help(HELP));
    }
    let without_mark = |text: &'a str| {
        if first_line > 1 { text } else { text.strip_prefix('\u{feff}').unwrap_or(text) }
    };
    std::str::from_utf8(bytes).map(without_mark).map_err(|invalid| {
        let at = invalid.valid_up_to();
        let byte = bytes.get(at).copied().unwrap_or(0);
        let number = before + at as u64 + 1;
        let problem = problem!(
            "encoding",
            &line_of_bytes(bytes, at, shown, first_line),
            "byte {number} of `{shown}`, hexadecimal {byte:02x}, is not UTF-8"
        );
        let label = latin(byte).map(|letter| format!("`{letter}` if the file is Windows-1252"));
        Problem { label, ..problem }.help(HELP)
    })
}

/// The character of a byte in Windows-1252, which many measuring systems write; only letters and
/// unit signs.
fn latin(byte: u8) -> Option<char> {
    let letter = char::from(byte);
    (letter.is_alphabetic() || matches!(letter, '°' | '²' | '³' | 'µ' | '±' | '·'))
        .then_some(letter)
}

/// The line around an invalid byte, with replacement characters.
fn line_of_bytes(bytes: &[u8], at: usize, shown: &str, first_line: usize) -> Span {
    let start = memchr::memrchr(b'\n', &bytes[..at]).map_or(0, |before| before + 1);
    let end = memchr::memchr(b'\n', &bytes[at..]).map_or(bytes.len(), |after| at + after);
    let before = String::from_utf8_lossy(&bytes[start..at]).into_owned();
    let after = String::from_utf8_lossy(&bytes[at..end]);
    let place = before.len()..before.len() + after.chars().next().map_or(0, char::len_utf8);
    let line = first_line + memchr::memchr_iter(b'\n', &bytes[..start]).count();
    Source::excerpt(shown, before + after.trim_end_matches('\r'), line).span(place)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_encodings_are_named_or_placed() {
        assert_eq!(decode("\u{feff}ab".as_bytes(), "f"), Ok("ab"));
        for bytes in [&b"\xff\xfea\0"[..], b"\xfe\xff\0a", b"a\0b\0", b"\0a\0b"] {
            assert!(
                decode(bytes, "f").is_err_and(|problem| problem.says.contains("UTF-16")),
                "{bytes:?}"
            );
        }
        let problem = decode(b"one\r\nK\xf6ln\r\n", "f").expect_err("Latin-1");
        assert_eq!(problem.at.map(|at| at.to_string()), Some("f:2:2".into()));
        assert!(problem.says.starts_with("byte 7 of `f`, hexadecimal f6"), "{}", problem.says);
        assert_eq!(problem.label.as_deref(), Some("`ö` if the file is Windows-1252"));
    }
}
