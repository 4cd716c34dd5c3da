//! The characters of a text file.

use std::borrow::Cow;

use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1252};

use crate::problem::{Problem, error};
use crate::source::Source;

/// The text of a file, and the name of its encoding.
///
/// # Errors
/// `encoding`.
pub fn text<'a>(
    bytes: &'a [u8],
    said: Option<&str>,
    shown: &str,
) -> Result<(Cow<'a, str>, &'static str), Problem> {
    if bytes.starts_with(&[0xff, 0xfe, 0, 0]) || bytes.starts_with(&[0, 0, 0xfe, 0xff]) {
        return Err(Problem::error("encoding", format!("`{shown}` is UTF-32 text"))
            .help("save it as UTF-8"));
    }
    let encoding = match said {
        Some(label) => Encoding::for_label(label.as_bytes()).ok_or_else(|| {
            let known =
                ["utf-8", "windows-1252", "iso-8859-15", "utf-16le", "utf-16be", "windows-1250"];
            Problem::error("encoding", format!("`{label}` is not a known encoding"))
                .suggest(label, known)
        })?,
        None => match wide(bytes) {
            Some(wide) => wide,
            None if std::str::from_utf8(bytes).is_ok() => UTF_8,
            // Measuring systems on Windows write it. It has a character for every byte, so that it
            // never fails.
            None => WINDOWS_1252,
        },
    };
    // A byte order mark is stronger than what was said.
    let (text, used, bad) = encoding.decode(bytes);
    if bad {
        let at = text.find('\u{fffd}').unwrap_or(0);
        let start = text[..at].rfind('\n').map_or(0, |before| before + 1);
        let line = 1 + text[..start].matches('\n').count();
        let end = text[at..].find('\n').map_or(text.len(), |after| at + after);
        let (from, to) = around(&text[start..end], at - start);
        let excerpt = Source::excerpt(shown, &text[start + from..start + to], line);
        let at = at - start - from;
        let says = format!("`{shown}` has bytes that are not {}", used.name());
        return Err(error("encoding", says, &excerpt.span(at..at + '\u{fffd}'.len_utf8())).help(
            "name the encoding of the file, for example `windows-1252`, or save it as UTF-8",
        ));
    }
    Ok((text, used.name()))
}

/// UTF-16 by its byte order mark, or by zeros in every other byte of Latin text.
pub fn wide(bytes: &[u8]) -> Option<&'static Encoding> {
    match bytes {
        [0xff, 0xfe, ..] => Some(UTF_16LE),
        [0xfe, 0xff, ..] => Some(UTF_16BE),
        [a, 0, b, 0, ..] if printable(*a) && printable(*b) => Some(UTF_16LE),
        [0, a, 0, b, ..] if printable(*a) && printable(*b) => Some(UTF_16BE),
        _ => None,
    }
}

fn printable(byte: u8) -> bool {
    matches!(byte, b' '..=b'~' | b'\t' | b'\r' | b'\n')
}

/// Bytes of a line shown on each side of a place.
const SHOWN: usize = 120;

/// A part of a line around a place, on boundaries of characters: a line can be as long as the file.
pub fn around(line: &str, at: usize) -> (usize, usize) {
    let mut from = at.saturating_sub(SHOWN);
    while !line.is_char_boundary(from) {
        from -= 1;
    }
    let mut to = (at + SHOWN).min(line.len());
    while !line.is_char_boundary(to) {
        to += 1;
    }
    (from, to)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8], said: Option<&str>) -> Result<(String, &'static str), Problem> {
        text(bytes, said, "f").map(|(text, name)| (text.into_owned(), name))
    }

    #[test]
    fn encodings_are_detected() {
        assert_eq!(read("\u{feff}m/s²".as_bytes(), None), Ok(("m/s²".into(), "UTF-8")));
        assert_eq!(read(b"m/s\xb2", None), Ok(("m/s²".into(), "windows-1252")));
        assert_eq!(read(b"\xff\xfem\0\xb2\0", None), Ok(("m²".into(), "UTF-16LE")));
        assert_eq!(read(b"m\0/\0s\0\xb2\0", None), Ok(("m/s²".into(), "UTF-16LE")));
        assert_eq!(read(b"\0m\0/\0s\0\xb2", None), Ok(("m/s²".into(), "UTF-16BE")));
        assert_eq!(read(b"\xe8", Some("windows-1250")), Ok(("č".into(), "windows-1250")));
    }

    #[test]
    fn what_is_not_of_the_encoding_has_a_place() {
        let problem = read(b"a\nb\xb2", Some("utf-8")).expect_err("not UTF-8");
        assert_eq!(
            (problem.code, problem.at.map(|at| at.to_string())),
            ("encoding", Some("f:2:2".into()))
        );
        assert!(read(b"a", Some("utf-9")).is_err_and(|problem| problem.help.is_some()));
        assert!(read(b"\xff\xfe\0\0a\0\0\0", None).is_err());
    }
}
