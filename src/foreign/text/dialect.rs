//! Lines, cells, separator and decimal mark.

use std::borrow::Cow;
use std::ops::Range;

use super::super::Options;
use super::{numbers, stamps};
use crate::units::Unit;
use crate::yaml::Words;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separator {
    Mark(char),
    /// Any number of blanks and tabs.
    Blanks,
}

impl Words for Separator {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("comma", Self::Mark(',')),
        ("semicolon", Self::Mark(';')),
        ("tab", Self::Mark('\t')),
        ("blanks", Self::Blanks),
        ("bar", Self::Mark('|')),
    ];

    /// Also a single mark, as it is.
    fn from_word(word: &str) -> Option<Self> {
        let mut letters = word.chars();
        let known = Self::WORDS.iter().find(|(known, _)| *known == word).map(|(_, value)| *value);
        let mark = letters.next().filter(|letter| !letter.is_alphanumeric()).map(Self::Mark);
        known.or(mark.filter(|_| letters.next().is_none()))
    }
}

/// What stands before the fraction of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DecimalMark {
    Comma,
    Point,
}

impl DecimalMark {
    /// The mark itself.
    pub(super) fn letter(self) -> char {
        if self == Self::Comma { ',' } else { '.' }
    }
}

impl Words for DecimalMark {
    const WORDS: &'static [(&'static str, Self)] =
        &[("comma", Self::Comma), ("point", Self::Point), (",", Self::Comma), (".", Self::Point)];
}

impl Separator {
    /// In words, for facts.
    pub(super) fn words(self) -> String {
        match self {
            Self::Mark('\t') => "tab".into(),
            Self::Mark(mark) => format!("`{mark}`"),
            Self::Blanks => "blanks".into(),
        }
    }
}

/// A line without its line break.
#[derive(Clone, Copy, Debug)]
pub struct Line<'a> {
    /// From 1.
    pub number: usize,
    pub text: &'a str,
}

/// The lines of a text with LF, CR LF or CR.
pub fn lines(text: &str) -> Vec<Line<'_>> {
    let old = !text.contains('\n');
    let split = text.split(if old { '\r' } else { '\n' });
    let mut next = 1;
    split
        .map(|line| {
            let number = next;
            next += 1 + line.matches(BREAK).count();
            Line { number, text: line.strip_suffix('\r').unwrap_or(line) }
        })
        .collect()
}

/// Stands for a line break in quotes.
const BREAK: char = '\u{b}';

/// A text with the minus of typesetters as that of keyboards, and with [`BREAK`] for line breaks in
/// quotes.
pub fn plainly(text: Cow<'_, str>) -> Cow<'_, str> {
    /// Most lines of a cell.
    const MOST: usize = 8;
    const MINUS: char = '\u{2212}';
    let text = if text.contains(MINUS) { text.replace(MINUS, "-").into() } else { text };
    if !text.contains('"') || !text.split('\n').any(|line| is_open(line, false)) {
        return text;
    }
    let lines: Vec<&str> = text.split('\n').collect();
    let (mut plain, mut at) = (String::with_capacity(text.len()), 0);
    while at < lines.len() {
        let (mut end, mut open) = (at, is_open(lines[at], false));
        while open && end + 1 < lines.len() && end - at < MOST {
            end += 1;
            open = is_open(lines[end], true);
        }
        // A quote that is not closed stands for itself.
        let end = if open { at } else { end };
        plain += &lines[at..=end].join(&BREAK.to_string());
        at = end + 1;
        plain += if at < lines.len() { "\n" } else { "" };
    }
    plain.into()
}

/// Whether a quoted cell is open at the end of a line. A quote opens a cell at its beginning, and
/// closes it at its end.
fn is_open(line: &str, mut open: bool) -> bool {
    let is_edge = |edge: Option<char>| {
        edge.is_none_or(|edge| matches!(edge, ',' | ';' | '\t' | '|' | ' ' | '\r'))
    };
    for (at, _) in line.match_indices('"') {
        let (before, after) = (line[..at].chars().next_back(), line[at + 1..].chars().next());
        open = if open { !is_edge(after) } else { is_edge(before) };
    }
    open
}

/// The separator that a line `sep=;` states.
pub fn stated_separator(line: &str) -> Option<char> {
    let mut rest = line.trim_matches('"').strip_prefix("sep=")?.chars();
    rest.next().filter(|_| rest.next().is_none())
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dialect {
    pub separator: Separator,
    pub decimal: char,
    /// Number of cells of a row.
    pub columns: usize,
}

/// Cells of a line: bytes of the line without quotes and surrounding blanks.
pub fn split(line: &str, separator: Separator) -> Vec<Range<usize>> {
    let mut cells = Vec::new();
    let mut from = 0;
    match separator {
        Separator::Blanks => {
            while let Some(start) =
                line[from..].find(|c: char| !c.is_whitespace()).map(|at| from + at)
            {
                let end = match line[start..].strip_prefix('"').and_then(|rest| rest.find('"')) {
                    Some(close) => start + close + 2,
                    None => {
                        line[start..].find(char::is_whitespace).map_or(line.len(), |at| start + at)
                    }
                };
                // Columns of fixed width may touch: `-1.500000E+03-1.380000E+03`.
                let end = touching(&line[start..end]).map_or(end, |at| start + at);
                cells.push(trim(line, start..end));
                from = end;
            }
        }
        Separator::Mark(mark) => {
            let quotes = line.contains('"');
            loop {
                // A separator in quotes does not separate.
                let skip = if quotes { quoted(&line[from..], mark) } else { 0 };
                let end = line[from + skip..].find(mark).map_or(line.len(), |at| from + skip + at);
                cells.push(trim(line, from..end));
                if end >= line.len() {
                    break;
                }
                from = end + mark.len_utf8();
            }
        }
    }
    cells
}

/// Where a number with a decimal mark ends and the sign of the next one stands.
fn touching(word: &str) -> Option<usize> {
    let bytes = word.as_bytes();
    let is_number = |part: &[u8]| {
        let marks = part.iter().filter(|byte| matches!(byte, b'.' | b',')).count();
        let known = |byte: &u8| byte.is_ascii_digit() || b".,+-eEdD".contains(byte);
        marks == 1 && part.iter().all(known)
    };
    let mut signs = (1..bytes.len()).filter(|at| {
        matches!(bytes[*at], b'-' | b'+') && matches!(bytes[at - 1], b'0'..=b'9' | b'.')
    });
    let first = signs.next()?;
    let end = signs.next().unwrap_or(bytes.len());
    (is_number(&bytes[..first]) && is_number(&bytes[first..end])).then_some(first)
}

/// Bytes of a quoted cell at the start of a text, or 0.
fn quoted(text: &str, separator: char) -> usize {
    let blanks = |c: char| c == ' ' || c == '\t' && separator != '\t';
    let open = text.len() - text.trim_start_matches(blanks).len();
    let Some(inside) = text[open..].strip_prefix('"') else { return 0 };
    let mut from = 0;
    while let Some(close) = inside[from..].find('"').map(|at| from + at) {
        let after = &inside[close + 1..];
        let rest = after.trim_start_matches(blanks);
        if rest.is_empty() || rest.starts_with(separator) {
            return open + 1 + close + 1;
        }
        from = close + 1 + usize::from(after.starts_with('"'));
    }
    0
}

fn trim(line: &str, place: Range<usize>) -> Range<usize> {
    let inner = |range: Range<usize>| {
        let text = &line[range.clone()];
        let start = range.start + (text.len() - text.trim_start().len());
        start..start + text.trim().len()
    };
    let place = inner(place);
    let text = &line[place.clone()];
    if text.len() >= 2 && text.starts_with('"') && text.ends_with('"') {
        inner(place.start + 1..place.end - 1)
    } else {
        place
    }
}

/// Beginnings of comments that are recognised without being named.
const COMMENTS: [&str; 5] = ["#", "%", "!", "//", "*"];

/// The text after the mark of a comment.
pub fn comment<'a>(line: &'a str, options: &Options) -> Option<&'a str> {
    let start = line.trim_start();
    match &options.comment {
        Some(mark) => (!mark.is_empty()).then(|| start.strip_prefix(mark.as_str())).flatten(),
        None => COMMENTS.iter().find_map(|mark| start.strip_prefix(mark)),
    }
}

/// Whether a line can be a row: neither blank nor a comment.
pub fn is_row(line: Line<'_>, options: &Options) -> bool {
    !line.text.trim().is_empty() && comment(line.text, options).is_none()
}

/// Whether a line has numbers alone.
fn is_numbers(line: Line<'_>, separator: Separator, options: &Options) -> bool {
    let cells = split(line.text, separator);
    let all = |decimal: char| numbers_among(line.text, &cells, decimal) == Some(cells.len());
    is_row(line, options) && (all('.') || all(','))
}

/// The first line behind so many lines of the file: one that states the separator is not among
/// these, and one may go over several.
pub fn behind(lines: &[Line<'_>], count: usize) -> usize {
    lines.iter().position(|line| line.number > count).unwrap_or(lines.len())
}

/// The first line of numbers.
fn first_of_numbers(lines: &[Line<'_>], separator: Separator, options: &Options) -> usize {
    let first = lines.iter().position(|line| is_numbers(*line, separator, options));
    options.header_lines.map(|count| behind(lines, count)).or(first).unwrap_or(lines.len())
}

/// The lines with each row as one line: so many lines of the file are a row.
pub fn joined(lines: &[Line<'_>], options: &Options, each: usize) -> Vec<(usize, String)> {
    let Some(Dialect { separator, .. }) = detect(lines, options) else { return Vec::new() };
    let mark = if let Separator::Mark(mark) = separator { mark } else { ' ' };
    let (before, rows) = lines.split_at(first_of_numbers(lines, separator, options));
    let rows: Vec<&Line<'_>> = rows.iter().filter(|line| is_row(**line, options)).collect();
    let row = |parts: &[&Line<'_>]| {
        let part = |line: &Line<'_>| {
            let text = line.text.trim_end();
            text.strip_suffix(mark).unwrap_or(text).to_owned()
        };
        let text = parts.iter().map(|line| part(line));
        (parts[0].number, text.collect::<Vec<_>>().join(&mark.to_string()))
    };
    let before = before.iter().map(|line| (line.number, line.text.to_string()));
    before.chain(rows.chunks(each.max(1)).map(row)).collect()
}

/// Rows that go over several lines each: how many, and the first line that is not a row of its own.
pub fn wrapped<'a>(
    lines: &[Line<'a>],
    dialect: Dialect,
    options: &Options,
) -> Option<(usize, Line<'a>)> {
    /// Most lines of a row, and rows that are compared.
    const MOST: usize = 16;
    const ROWS: usize = 3;
    let first = first_of_numbers(lines, dialect.separator, options);
    let (before, rows) = lines.split_at(first);
    let cells = |line: &Line<'a>| split(line.text, dialect.separator).len();
    let rows: Vec<Line<'a>> =
        rows.iter().filter(|line| is_row(**line, options)).take(MOST * ROWS).copied().collect();
    let counts: Vec<usize> = rows.iter().map(cells).collect();
    let (second, count) = (*rows.get(1)?, counts[0]);
    if counts.iter().any(|other| *other != count) {
        let each = (2..=MOST).find(|each| {
            let cycle = counts.iter().zip(counts.iter().cycle().skip(*each));
            counts.len() >= each * ROWS
                && cycle.take(counts.len() - each).all(|(one, other)| one == other)
        })?;
        return Some((each, second));
    }
    // Names for several lines, none of them a unit.
    let names = before.iter().rev().find(|line| is_row(**line, options))?;
    let words: Vec<&str> =
        split(names.text, dialect.separator).into_iter().map(|cell| &names.text[cell]).collect();
    let is_unit = |word: &&str| word.starts_with(['[', '(']) || Unit::parse(word).is_ok();
    let several = words.len() / count.max(1);
    let fits = several > 1 && several <= MOST && words.len() == several * count;
    let is_name = |word: &&str| word.starts_with(char::is_alphabetic);
    (fits
        && words.iter().all(is_name)
        && 3 * words.iter().filter(|word| is_unit(word)).count() < words.len())
    .then_some((several, second))
}

/// Lines looked at to detect the dialect.
const SAMPLE: usize = 300;
/// Bytes of these lines looked at.
const SAMPLE_BYTES: usize = 1 << 20;

/// Detects what was not said, from lines in the middle of the file, where there is no header.
pub fn detect(lines: &[Line<'_>], options: &Options) -> Option<Dialect> {
    let from = options.header_lines.map_or_else(
        || (lines.len() / 2).min(lines.len().saturating_sub(SAMPLE)),
        |count| behind(lines, count),
    );
    let mut bytes = 0;
    let sample: Vec<&str> = lines[from..]
        .iter()
        .filter(|line| is_row(**line, options))
        .map(|line| line.text)
        .take(SAMPLE)
        .take_while(|line| {
            bytes += line.len();
            bytes <= SAMPLE_BYTES
        })
        .collect();
    let separators = match options.separator {
        Some(said) => vec![said],
        None => {
            let marks = [';', '\t', ',', '|'].map(Separator::Mark);
            marks.into_iter().chain([Separator::Blanks]).collect()
        }
    };
    let decimals = match options.decimal {
        Some(said) => vec![said.letter()],
        None => vec!['.', ','],
    };
    // A decimal comma between commas stands in quotes.
    let quoted = sample.iter().any(|line| line.contains('"'));
    let mut best: Option<(f64, Dialect)> = None;
    for separator in separators {
        for decimal in
            decimals.iter().copied().filter(|mark| separator != Separator::Mark(*mark) || quoted)
        {
            let rows: Vec<(usize, f64)> =
                sample.iter().filter_map(|line| weigh(line, separator, decimal)).collect();
            let Some(columns) = most_frequent(rows.iter().map(|(cells, _)| *cells)) else {
                continue;
            };
            let score: f64 =
                rows.iter().filter(|(cells, _)| *cells == columns).map(|(_, weight)| weight).sum();
            if best.is_none_or(|(before, _)| score > before) {
                best = Some((score, Dialect { separator, decimal, columns }));
            }
        }
    }
    best.map(|(_, dialect)| dialect)
}

/// Number of cells of a row of numbers, and its weight: the more of its cells are numbers, the
/// better fits the dialect.
fn weigh(line: &str, separator: Separator, decimal: char) -> Option<(usize, f64)> {
    let mut cells = split(line, separator);
    // A separator at the end of the line.
    if cells.len() > 1 && cells.last().is_some_and(Range::is_empty) {
        cells.pop();
    }
    // A number with marks between thousands tells less than one with a decimal mark.
    let grouped = |cell: &&Range<usize>| {
        matches!(numbers::read(&line[(*cell).clone()], decimal), numbers::Cell::Thousands(_))
    };
    let half = 0.5 * cells.iter().filter(grouped).count() as f64;
    let numbers = numbers_among(line, &cells, decimal)? as f64 - half;
    Some((cells.len(), numbers * numbers / cells.len() as f64))
}

/// Number of cells that are numbers, time stamps or empty, if a row can be one of numbers: at least
/// one number or time, and half of the cells.
pub fn numbers_among(line: &str, cells: &[Range<usize>], decimal: char) -> Option<usize> {
    let (mut numbers, mut empty) = (0, 0);
    for cell in cells {
        let text = &line[cell.clone()];
        match numbers::read(text, decimal) {
            numbers::Cell::Empty => empty += 1,
            numbers::Cell::Other if stamps::read(text).is_none() => {}
            _ => numbers += 1,
        }
    }
    (numbers > 0 && 2 * (numbers + empty) >= cells.len()).then_some(numbers + empty)
}

fn most_frequent(counts: impl Iterator<Item = usize>) -> Option<usize> {
    let mut counts: Vec<usize> = counts.collect();
    counts.sort_unstable();
    counts.chunk_by(|a, b| a == b).max_by_key(|same| same.len()).map(|same| same[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> Option<(String, char, usize)> {
        detect(&lines(text), &Options::default())
            .map(|dialect| (dialect.separator.words(), dialect.decimal, dialect.columns))
    }

    #[test]
    fn dialects_are_detected() {
        for (text, separator, decimal, columns) in [
            ("t;y\ns;kN\n0,000;1,5\n0,005;1,25\n", "`;`", ',', 2),
            ("t,y\n0.0,1.5\n0.1,2\n", "`,`", '.', 2),
            ("t\ty\n0.0\t1.5\n0.1\t\n", "tab", '.', 2),
            ("t y\n0.0  1.5\n0.1  2\n", "blanks", '.', 2),
            ("t y\n0,0  1,5\n0,1  2,5\n", "blanks", ',', 2),
            ("a;b;c\n1.234,5;1;2\n2.345,6;3;4\n", "`;`", ',', 3),
            ("Zeit;y\n13.05.2024 12:00:00,005;1,5\n13.05.2024 12:00:00,010;1,5\n", "`;`", ',', 2),
            ("date time y\n2024-05-13 12:00:00 1.5\n", "blanks", '.', 3),
            ("a, b\n1, 2\n3, 4\n", "`,`", '.', 2),
            ("a;b;\n1,5;2,5;\n", "`;`", ',', 2),
        ] {
            assert_eq!(found(text), Some((separator.into(), decimal, columns)), "{text}");
        }
        assert_eq!(found("one\ntwo\n"), None);
    }

    #[test]
    fn cells_have_their_places() {
        let cells = |line: &str, separator| -> Vec<String> {
            split(line, separator).into_iter().map(|cell| line[cell].to_string()).collect()
        };
        let semicolon = Separator::Mark(';');
        assert_eq!(cells("a; \"b;c\" ;;d ", semicolon), ["a", "b;c", "", "d"]);
        assert_eq!(cells("\"a", semicolon), ["\"a"]);
        assert_eq!(cells("", semicolon), [""]);
        assert_eq!(cells("\"a\"\"b;\";c", semicolon), ["a\"\"b;", "c"]);
        assert_eq!(cells(" 1  2\t\"a b\" ", Separator::Blanks), ["1", "2", "a b"]);
        assert_eq!(cells("", Separator::Blanks), [""; 0]);
    }
}
