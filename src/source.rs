//! The text of an input file, and spans in it.
//!
//! A [`Span`] contains its source, so that a problem can be printed without a table of files.

use std::{
    fmt,
    ops::Range,
    sync::{Arc, OnceLock},
};

use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error as _};

/// One input text: a protocol, a YAML or CSV file, or an excerpt of one.
pub struct Source {
    /// Name shown to the user: the path as given, or `protocols/<name>.fp` for an embedded
    /// protocol.
    pub name: String,
    pub text: String,
    /// Number of the first line of `text` in the file (1 unless this is an excerpt).
    pub first_line: usize,
    /// Where the lines of the text begin, computed on first use: a large table requests them for
    /// each row.
    lines: OnceLock<Vec<usize>>,
}

impl PartialEq for Source {
    fn eq(&self, other: &Self) -> bool {
        (&self.name, &self.text, self.first_line) == (&other.name, &other.text, other.first_line)
    }
}

impl Eq for Source {}

impl fmt::Debug for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

impl Source {
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Arc<Self> {
        Self::excerpt(name, text, 1)
    }

    /// A few lines of a large file, so that a problem in row 30 000 of a record does not keep the
    /// record.
    pub fn excerpt(
        name: impl Into<String>,
        text: impl Into<String>,
        first_line: usize,
    ) -> Arc<Self> {
        Arc::new(Self { name: name.into(), text: text.into(), first_line, lines: OnceLock::new() })
    }

    /// The name without its folders, independent of the working folder.
    pub fn file_name(&self) -> String {
        std::path::Path::new(&self.name)
            .file_name()
            .map_or_else(|| self.name.clone(), |name| name.to_string_lossy().into_owned())
    }

    /// Line and column (both from 1, column in characters) of a byte offset.
    pub fn line_column(&self, offset: usize) -> (usize, usize) {
        let offset = self.text.floor_char_boundary(offset);
        let ends = || memchr::memchr_iter(b'\n', self.text.as_bytes()).map(|end| end + 1);
        let starts = self.lines.get_or_init(|| std::iter::once(0).chain(ends()).collect());
        let line = starts.partition_point(|start| *start <= offset) - 1;
        (self.first_line + line, self.text[starts[line]..offset].chars().count() + 1)
    }

    pub fn span(self: &Arc<Self>, range: Range<usize>) -> Span {
        Span { source: Arc::clone(self), start: range.start, end: range.end, filled: None }
    }

    /// The span of the whole text.
    pub fn whole(self: &Arc<Self>) -> Span {
        self.span(0..self.text.len())
    }
}

/// What is written somewhere, so that a problem can point at it.
pub trait Located {
    /// The place to underline.
    fn place(&self) -> Span;
}

impl<T: Located + ?Sized> Located for &T {
    fn place(&self) -> Span {
        (*self).place()
    }
}

impl Located for Span {
    fn place(&self) -> Span {
        self.clone()
    }
}

impl<T> Located for Spanned<T> {
    fn place(&self) -> Span {
        self.span.clone()
    }
}

/// A range of bytes in a source.
#[derive(Clone, PartialEq, Eq)]
pub struct Span {
    pub source: Arc<Source>,
    pub start: usize,
    pub end: usize,
    /// In a block of a family: the text with the words of its member inserted.
    pub filled: Option<Arc<Filled>>,
}

impl Span {
    /// The text of the span, with the words of the member inserted in a block of a family.
    pub fn text(&self) -> &str {
        match &self.filled {
            Some(filled) => &filled.text,
            None => self.source.text.get(self.start..self.end).unwrap_or(""),
        }
    }

    /// A part of this span, in bytes of its text, kept inside it.
    pub fn part(&self, range: Range<usize>) -> Span {
        if let Some(filled) = &self.filled {
            return filled.part(self, range, true);
        }
        let start = (self.start + range.start).min(self.end);
        let end = (self.start + range.end).clamp(start, self.end);
        Span { source: Arc::clone(&self.source), start, end, filled: None }
    }

    /// The same place, restricted to these bytes of its text. Their place in the source is not
    /// known.
    pub fn of_which(&self, range: Range<usize>) -> Span {
        match &self.filled {
            Some(filled) => filled.part(self, range, false),
            None => self.clone(),
        }
    }

    /// From the start of this span to the end of another in the same source.
    pub fn to(&self, other: &Span) -> Span {
        Span {
            source: Arc::clone(&self.source),
            start: self.start,
            end: other.end.max(self.start),
            filled: None,
        }
    }

    pub fn line(&self) -> usize {
        self.source.line_column(self.start).0
    }
}

/// A span as it is stored: with the lines that it is in, so that a problem is rendered as before.
#[derive(Serialize, Deserialize)]
struct Stored {
    name: String,
    first_line: usize,
    text: String,
    start: usize,
    end: usize,
}

/// Bytes of a line behind a place that are stored with it. Rows of records are shorter; a file in a
/// wrong format may be one line.
const BEHIND: usize = 4096;

impl Serialize for Span {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let text = &self.source.text;
        let start = text.floor_char_boundary(self.start);
        let end = text.floor_char_boundary(self.end.max(self.start));
        let from = text[..start].rfind('\n').map_or(0, |at| at + 1);
        let to_line = text[end..].find('\n').map_or(text.len(), |at| end + at);
        let to_line = text.floor_char_boundary(to_line.min(end + BEHIND));
        let first_line = self.source.line_column(start).0;
        let (name, text) = (self.source.name.clone(), text[from..to_line].to_string());
        Stored { name, first_line, text, start: start - from, end: end - from }.serialize(to)
    }
}

impl<'de> Deserialize<'de> for Span {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let Stored { name, first_line, text, start, end } = Stored::deserialize(from)?;
        if start > end
            || end > text.len()
            || !text.is_char_boundary(start)
            || !text.is_char_boundary(end)
        {
            return Err(D::Error::custom(format!("a place in `{name}` that is not in its text")));
        }
        Ok(Source::excerpt(name, text, first_line).span(start..end))
    }
}

/// `file:line:column`
impl fmt::Display for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, column) = self.source.line_column(self.start);
        write!(f, "{}:{line}:{column}", self.source.name)
    }
}

impl fmt::Debug for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// A text of a family of blocks, as it is for one of its members.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Filled {
    pub text: String,
    pub member: Arc<Member>,
    /// The pieces of the text, in order and without gaps.
    pub pieces: Vec<Piece>,
}

/// One block of a family, by both names: `Y_phase` of `Y_{part}`.
#[derive(Debug, PartialEq, Eq)]
pub struct Member {
    pub name: String,
    pub family: String,
}

/// A part of a text of a family.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Piece {
    /// Bytes of the text.
    pub text: Range<usize>,
    /// Their origin, in bytes from the start of the span: the same bytes, or `{part}`.
    pub from: Range<usize>,
    /// The word inserted for braces, with its place.
    pub put_in: Option<Arc<Spanned<String>>>,
}

impl Filled {
    fn part(&self, span: &Span, range: Range<usize>, exact: bool) -> Span {
        let end = range.end.max(range.start + 1);
        let touches = |piece: &&Piece| piece.text.start < end && range.start < piece.text.end;
        let touched = || self.pieces.iter().filter(touches);
        let (Some(first), Some(last)) = (touched().next(), touched().next_back()) else {
            return span.clone();
        };
        // Bytes of a piece before the range and behind it; braces are taken as a whole.
        let (from, to) = (range.start, range.end.max(range.start));
        let ahead = |piece: &Piece| match piece.put_in {
            Some(_) => 0,
            None => from.saturating_sub(piece.text.start),
        };
        let behind = |piece: &Piece| match piece.put_in {
            Some(_) => 0,
            None => piece.text.end.saturating_sub(to),
        };
        let from = first.from.start + ahead(first);
        let to = last.from.end.saturating_sub(behind(last)).max(from);
        let shift = if exact { from } else { 0 };
        let pieces = touched().map(|piece| {
            let start = piece.from.start + ahead(piece);
            let end = (piece.from.end - behind(piece)).max(start);
            Piece {
                text: piece.text.start.max(range.start) - range.start
                    ..piece.text.end.min(range.end.max(range.start)) - range.start,
                from: start - shift..end - shift,
                put_in: piece.put_in.clone(),
            }
        });
        let text = self.text.get(range.start..range.end.min(self.text.len())).unwrap_or("");
        let (text, member) = (text.to_owned(), Arc::clone(&self.member));
        let filled = Self { text, member, pieces: pieces.collect() };
        let (start, end) =
            if exact { (span.start + from, span.start + to) } else { (span.start, span.end) };
        Span { source: Arc::clone(&span.source), start, end, filled: Some(Arc::new(filled)) }
    }

    /// The inserted word, if the text has only one.
    pub fn put_in(&self) -> Option<&Spanned<String>> {
        let mut found = self.pieces.iter().filter_map(|piece| piece.put_in.as_deref());
        let first = found.next()?;
        found.all(|other| other == first).then_some(first)
    }
}

/// A value and the place where it was written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Spanned<T> {
    pub value: T,
    pub span: Span,
}

impl<T> Spanned<T> {
    pub fn new(value: T, span: Span) -> Self {
        Self { value, span }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters_and_excerpts_keep_their_line() {
        let source = Source::excerpt("a.csv", "ä,b\nc", 10);
        assert_eq!(source.line_column(3), (10, 3));
        assert_eq!(source.line_column(5), (11, 1));
        assert_eq!(source.span(5..6).to_string(), "a.csv:11:1");
    }

    #[test]
    fn a_stored_line_ends_soon_behind_the_place() {
        let source = Source::new("a.csv", format!("a,b\nc,{}\n", "1".repeat(100_000)));
        let stored = serde_json::to_string(&source.span(6..7)).expect("stored");
        assert!(stored.len() < 5000, "{}", stored.len());
        let again: Span = serde_json::from_str(&stored).expect("read");
        assert_eq!((again.to_string(), again.text()), ("a.csv:2:3".to_string(), "1"));
    }

    #[test]
    fn a_stored_place_is_the_same_place() {
        let source = Source::excerpt("a.csv", "ä,b\nc,ö,e\nf", 10);
        for range in [0..2, 5..6, 7..9, 12..12, 5..13] {
            let span = source.span(range);
            let stored = serde_json::to_string(&span).expect("JSON");
            let read: Span = serde_json::from_str(&stored).expect("a span");
            assert_eq!(
                (read.to_string(), read.text()),
                (span.to_string(), span.text()),
                "{stored}"
            );
            assert!(read.source.text.lines().count() <= 2);
        }
        for wrong in [
            "{\"name\":\"a\",\"first_line\":1,\"text\":\"ä\",\"start\":0,\"end\":1}",
            "{\"name\":\"a\"}",
        ] {
            assert!(serde_json::from_str::<Span>(wrong).is_err());
        }
    }

    /// In `each {part}_limit` with `phase` inserted, places in the text refer to the source.
    #[test]
    fn places_lead_through_what_is_put_in() {
        let source = Source::new("p.fp", "limit each {part}_limit, phase");
        let member = Arc::new(Member { name: "Y_phase".into(), family: "Y_{part}".into() });
        let word = Arc::new(Spanned::new("phase".to_string(), source.span(25..30)));
        let pieces = vec![
            Piece { text: 0..5, from: 0..5, put_in: None },
            Piece { text: 5..10, from: 5..11, put_in: Some(word) },
            Piece { text: 10..16, from: 11..17, put_in: None },
        ];
        let filled = Filled { text: "each phase_limit".into(), member, pieces };
        let span = Span { filled: Some(Arc::new(filled)), ..source.span(6..23) };
        let written = |span: &Span| source.text[span.start..span.end].to_string();
        for (part, text, from, whole) in [
            (0..4, "each", "each", None),
            (5..16, "phase_limit", "{part}_limit", Some("phase")),
            (6..8, "ha", "{part}", Some("phase")),
            (11..16, "limit", "limit", None),
        ] {
            let found = span.part(part);
            assert_eq!((found.text(), written(&found).as_str()), (text, from));
            assert_eq!(
                found
                    .filled
                    .as_ref()
                    .and_then(|filled| filled.put_in())
                    .map(|word| word.value.as_str()),
                whole
            );
        }
        assert_eq!(written(&span.part(5..16).part(6..11)), "limit");
        assert_eq!(written(&span.part(16..16)), written(&span));
        let loose = span.of_which(11..16);
        assert_eq!((loose.text(), written(&loose).as_str()), ("limit", "each {part}_limit"));
    }
}
