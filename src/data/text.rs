//! From a file to its text: readable, not empty, UTF-8.

use std::fs::File;
use std::io::{BufRead, BufReader, ErrorKind, Read};
use std::path::Path;
use std::sync::Arc;

use super::hash::sha256;
use crate::problem::Problem;
use crate::source::{Source, Span};

/// Largest YAML file or table in bytes; protocols, vehicles and section tables have a few thousand.
const SMALL: u64 = 16 << 20;
/// Largest record in bytes.
const LARGE: u64 = 4 << 30;

/// A small text file, its byte order mark left out, and the SHA-256 of its bytes.
///
/// # Errors
/// `file-missing`, `file-unreadable`, `file-empty`, `file-too-large`, `encoding`.
pub fn read_text(path: &Path, shown: &str) -> Result<(Arc<Source>, String), Problem> {
    let mut bytes = Vec::new();
    read_bytes(path, shown, SMALL, &mut bytes)?;
    let text = decode(&bytes, shown)?;
    if text.trim().is_empty() {
        return Err(empty(shown));
    }
    Ok((Source::new(shown, text), sha256(&bytes)))
}

/// All bytes of a record file, in the place of what the buffer held.
pub(super) fn read_large(path: &Path, shown: &str, buffer: &mut Vec<u8>) -> Result<(), Problem> {
    read_bytes(path, shown, LARGE, buffer)
}

/// The first line of a record file.
pub(super) fn read_line(path: &Path, shown: &str) -> Result<Vec<u8>, Problem> {
    let unreadable = |error: std::io::Error| Problem::error("file-unreadable", format!("`{shown}` cannot be read: {error}"));
    if !path.is_file() {
        return Err(Problem::error("file-missing", format!("there is no file `{shown}`")));
    }
    let mut line = Vec::new();
    BufReader::new(File::open(path).map_err(unreadable)?.take(SMALL)).read_until(b'\n', &mut line).map_err(unreadable)?;
    if line.is_empty() { Err(empty(shown)) } else { Ok(line) }
}

/// All bytes of a plain file that is not empty and not larger than a limit.
///
/// # Errors
/// `file-missing`, `file-unreadable`, `file-empty`, `file-too-large`.
pub fn read_bytes(path: &Path, shown: &str, limit: u64, buffer: &mut Vec<u8>) -> Result<(), Problem> {
    let unreadable = |why: &dyn std::fmt::Display| Problem::error("file-unreadable", format!("`{shown}` cannot be read: {why}"));
    // What is no plain file is refused before it is opened: a pipe would wait for ever.
    let meta = std::fs::metadata(path).map_err(|error| match error.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => Problem::error("file-missing", format!("there is no file `{shown}`")),
        _ => unreadable(&error),
    })?;
    if !meta.is_file() {
        return Err(unreadable(if meta.is_dir() { &"it is a folder" } else { &"it is no plain file" }));
    }
    if meta.len() > limit {
        return Err(Problem::error(
            "file-too-large",
            format!("`{shown}` has {} MB; the most that is read is {} MB", meta.len() >> 20, limit >> 20),
        ));
    }
    buffer.clear();
    buffer.reserve(usize::try_from(meta.len()).unwrap_or(0) + 1);
    let file = File::open(path).map_err(|error| unreadable(&error))?;
    file.take(limit + 1).read_to_end(buffer).map_err(|error| unreadable(&error))?;
    if buffer.is_empty() { Err(empty(shown)) } else { Ok(()) }
}

fn empty(shown: &str) -> Problem {
    Problem::error("file-empty", format!("`{shown}` is empty"))
}

/// The text of a file without its byte order mark.
///
/// # Errors
/// `encoding`: the encoding by name where it can be told, else the first byte that is not UTF-8, with its row.
pub fn decode<'a>(bytes: &'a [u8], shown: &str) -> Result<&'a str, Problem> {
    const HELP: &str = "save the file as UTF-8";
    let wide = match bytes {
        // Longer marks first: UTF-32 begins like UTF-16.
        [0xff, 0xfe, 0, 0, ..] | [0, 0, 0xfe, 0xff, ..] => Some("UTF-32"),
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => Some("UTF-16"),
        // Latin text in UTF-16 without a mark has every other byte zero.
        [0, second, 0, fourth, ..] | [second, 0, fourth, 0, ..] if *second != 0 && *fourth != 0 => Some("UTF-16"),
        _ => None,
    };
    if let Some(encoding) = wide {
        return Err(Problem::error("encoding", format!("`{shown}` is {encoding} text, not UTF-8")).help(HELP));
    }
    std::str::from_utf8(bytes).map(|text| text.strip_prefix('\u{feff}').unwrap_or(text)).map_err(|error| {
        let at = error.valid_up_to();
        let byte = bytes.get(at).copied().unwrap_or(0);
        let says = format!("byte {} of `{shown}`, hexadecimal {byte:02x}, is not UTF-8", at + 1);
        let problem = Problem::error("encoding", says).at(&line_of_bytes(bytes, at, shown));
        match latin(byte) {
            Some(letter) => problem.label(format!("`{letter}` if the file is Windows-1252")).help(HELP),
            None => problem.help(HELP),
        }
    })
}

/// What the byte is in the encoding most old measuring systems write; only those that mean a letter or unit sign.
fn latin(byte: u8) -> Option<char> {
    let letter = char::from(byte);
    (letter.is_alphabetic() || matches!(letter, '°' | '²' | '³' | 'µ' | '±' | '·')).then_some(letter)
}

/// The line around a byte that is no text, shown with replacement characters.
fn line_of_bytes(bytes: &[u8], at: usize, shown: &str) -> Span {
    let start = memchr::memrchr(b'\n', &bytes[..at]).map_or(0, |before| before + 1);
    let end = memchr::memchr(b'\n', &bytes[at..]).map_or(bytes.len(), |after| at + after);
    let before = String::from_utf8_lossy(&bytes[start..at]).into_owned();
    let after = String::from_utf8_lossy(&bytes[at..end]);
    let place = before.len()..before.len() + after.chars().next().map_or(0, char::len_utf8);
    let line = 1 + memchr::memchr_iter(b'\n', &bytes[..start]).count();
    Source::excerpt(shown, before + after.trim_end_matches('\r'), line).span(place)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_encodings_are_named_or_placed() {
        assert_eq!(decode("\u{feff}ab".as_bytes(), "f"), Ok("ab"));
        for bytes in [&b"\xff\xfea\0"[..], b"\xfe\xff\0a", b"a\0b\0", b"\0a\0b"] {
            assert!(decode(bytes, "f").is_err_and(|problem| problem.says.contains("UTF-16")), "{bytes:?}");
        }
        let problem = decode(b"one\r\nK\xf6ln\r\n", "f").expect_err("Latin-1");
        assert_eq!(problem.at.map(|at| at.to_string()), Some("f:2:2".into()));
        assert!(problem.says.starts_with("byte 7 of `f`, hexadecimal f6"), "{}", problem.says);
        assert_eq!(problem.label.as_deref(), Some("`ö` if the file is Windows-1252"));
    }
}
