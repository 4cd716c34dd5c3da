//! The text of an input file, and spans in it.
//!
//! A [`Span`] contains its source, so that a problem can be printed without a table of files.

use std::fmt;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// One input text: a protocol, a YAML or CSV file, or an excerpt of one.
#[derive(PartialEq, Eq)]
pub struct Source {
    /// Name shown to the user: the path as given, or `protocols/<name>.fp` for an embedded protocol.
    pub name: String,
    pub text: String,
    /// Number of the first line of `text` in the file (1 unless this is an excerpt).
    pub first_line: usize,
    lines: Lines,
}

/// Start positions of the lines of a text, computed on first use: a large table requests them for each row.
#[derive(Default)]
struct Lines(OnceLock<Vec<usize>>);

/// Derived from the text.
impl PartialEq for Lines {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Eq for Lines {}

impl Lines {
    fn of(&self, text: &str) -> &[usize] {
        let ends = || memchr::memchr_iter(b'\n', text.as_bytes()).map(|end| end + 1);
        self.0.get_or_init(|| std::iter::once(0).chain(ends()).collect())
    }
}

impl fmt::Debug for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

impl Source {
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Arc<Self> {
        Self::excerpt(name, text, 1)
    }

    /// A few lines of a large file, so that a problem in row 30 000 of a record does not keep the record.
    pub fn excerpt(name: impl Into<String>, text: impl Into<String>, first_line: usize) -> Arc<Self> {
        Arc::new(Self { name: name.into(), text: text.into(), first_line, lines: Lines::default() })
    }

    /// The name without its folders, independent of the working folder.
    pub fn file_name(&self) -> String {
        std::path::Path::new(&self.name).file_name().map_or_else(|| self.name.clone(), |name| name.to_string_lossy().into_owned())
    }

    /// Line and column (both from 1, column in characters) of a byte offset.
    pub fn line_column(&self, offset: usize) -> (usize, usize) {
        let mut offset = offset.min(self.text.len());
        while !self.text.is_char_boundary(offset) {
            offset -= 1;
        }
        let starts = self.lines.of(&self.text);
        let line = starts.partition_point(|start| *start <= offset) - 1;
        (self.first_line + line, self.text[starts[line]..offset].chars().count() + 1)
    }

    pub fn span(self: &Arc<Self>, range: Range<usize>) -> Span {
        Span { source: Arc::clone(self), start: range.start, end: range.end }
    }

    /// The span of the whole text.
    pub fn whole(self: &Arc<Self>) -> Span {
        self.span(0..self.text.len())
    }
}

/// A range of bytes in a source.
#[derive(Clone, PartialEq, Eq)]
pub struct Span {
    pub source: Arc<Source>,
    pub start: usize,
    pub end: usize,
}

impl Span {
    pub fn text(&self) -> &str {
        self.source.text.get(self.start..self.end).unwrap_or("")
    }

    /// A part of this span, in bytes from its start, limited to it.
    pub fn part(&self, range: Range<usize>) -> Span {
        let start = (self.start + range.start).min(self.end);
        let end = (self.start + range.end).clamp(start, self.end);
        Span { source: Arc::clone(&self.source), start, end }
    }

    /// From the start of this span to the end of another in the same source.
    pub fn to(&self, other: &Span) -> Span {
        Span { source: Arc::clone(&self.source), start: self.start, end: other.end.max(self.start) }
    }

    pub fn line(&self) -> usize {
        self.source.line_column(self.start).0
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

/// A value and its place.
#[derive(Clone, Debug, PartialEq)]
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
}
