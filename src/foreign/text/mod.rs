//! Text tables of any dialect: CSV, and the ASCII exports of simulation programs.
//!
//! | file | content |
//! |---|---|
//! | `mod` | a text as a table: header, rows, columns |
//! | `dialect` | lines, cells, separator and decimal mark |
//! | `header` | names, units, list of channels, facts |
//! | `values` | the rows as columns of numbers |
//! | `numbers`, `stamps` | a cell as a number or a time |

mod dialect;
mod header;
mod numbers;
mod stamps;
mod values;

use std::ops::Range;

pub use dialect::{DecimalMark, Separator};
use dialect::{Dialect, Line, is_row};
#[cfg(feature = "foreign")]
pub use header::{most_are_units, over_two_rows, unbracketed};
pub use header::{name_and_unit, unit_of_name};
pub use stamps::{ClockForm, DateOrder};
#[cfg(feature = "foreign")]
pub use values::stamps_from_first;

use super::{Input, Options, Read, Table, decode};
use crate::problem::{Problem, error};
use crate::source::{Source, Span};
use crate::yaml::Words;

/// Maximum length of a line in bytes, as for a record of a campaign.
const LONGEST_LINE: usize = 1 << 20;

/// Maximum number of lines: each takes as much memory as 24 letters. At 5000 samples a second, these
/// are 56 minutes.
const MOST_LINES: usize = 16 << 20;

/// A text table, and how it is written.
#[derive(Clone, Copy)]
struct Text<'a> {
    shown: &'a str,
    options: &'a Options,
    dialect: Dialect,
}

/// Reads a text table.
pub fn read(input: &Input<'_>) -> Result<Read, Vec<Problem>> {
    let (shown, options) = (input.shown, input.options);
    if let (Some(separator), Some(mark)) = (options.separator, options.decimal)
        && separator == Separator::Mark(mark.letter())
    {
        let says = "the separator and the decimal mark are the same";
        return Err(Problem::error("dialect", says).into());
    }
    let (content, encoding) = decode::text(input.bytes, options.encoding.as_deref(), shown)?;
    let breaks = |of: u8| content.bytes().filter(|byte| *byte == of).count();
    if breaks(b'\n').max(breaks(b'\r')) > MOST_LINES {
        let says = format!("`{shown}` has more than {} million lines", MOST_LINES >> 20);
        return Err(Problem::error("too-many-values", says).help("divide it into files").into());
    }
    let content = dialect::plainly(content);
    let mut lines = dialect::lines(&content);
    // A first line of Excel, `sep=;`, states the separator.
    let stated;
    let (shown, mut options) = (shown, options);
    if let Some(mark) = lines.first().and_then(|line| dialect::stated_separator(line.text)) {
        lines.remove(0);
        let separator = options.separator.or(Some(Separator::Mark(mark)));
        stated = Options { separator, ..options.clone() };
        options = &stated;
    }
    if let Some(line) = lines.iter().find(|line| line.text.len() > LONGEST_LINE) {
        let says =
            format!("line {} of `{shown}` has more than {} MB", line.number, LONGEST_LINE >> 20);
        let problem = error("line-too-long", says, &at(shown, *line, 0..0));
        return Err(problem.help("export one line per sample").into());
    }
    let joined = options.lines_per_row.map(|each| dialect::joined(&lines, options, each));
    if let Some(joined) = &joined {
        lines = joined.iter().map(|(number, text)| Line { number: *number, text }).collect();
    }
    let no_numbers = || no_numbers(input, &lines);
    let dialect = dialect::detect(&lines, options).ok_or_else(no_numbers)?;
    if joined.is_none()
        && let Some((each, line)) = dialect::wrapped(&lines, dialect, options)
    {
        let says = format!("each row goes over {each} lines: this one goes on with the row before");
        let problem = error("wrapped-rows", says, &at(shown, line, 0..line.text.len()));
        return Err(problem.help(format!("say so in the mapping: `format: {{lines per row: {each}}}`; or `1` if each line is a row")).into());
    }
    let mut text = Text { shown, options, dialect };
    let start = text.first_row(&lines).ok_or_else(no_numbers)?;
    let (before, rows) = lines.split_at(start);
    text.dialect.columns += usize::from(text.last_is_empty(before, rows));
    let (rows, footer) = rows.split_at(text.end_of_rows(rows));
    let header = header::read(&text, before, rows.first().copied())?;
    input.budget().take(text.dialect.columns, rows.len(), "the table")?;
    let mut table = Table {
        facts: header.facts,
        first_row: rows.first().map_or(1, |line| line.number),
        ..Table::default()
    };
    values::read(&text, rows, header.columns, &mut table)?;
    let mut facts = vec![
        ("encoding".into(), encoding.into()),
        ("separator".into(), dialect.separator.words()),
        ("decimal mark".into(), format!("`{}`", dialect.decimal)),
        ("first line of numbers".into(), table.first_row.to_string()),
        ("form".into(), input.format.word().into()),
    ];
    if let Some(first) = footer.iter().find(|line| is_row(**line, options)) {
        let said = format!("left out from line {}", first.number);
        facts.push(("lines after the numbers".into(), said));
    }
    Ok(Read { tables: vec![table], facts })
}

impl Text<'_> {
    fn split(&self, line: &str) -> Vec<Range<usize>> {
        dialect::split(line, self.dialect.separator)
    }

    /// The cells of a line; a separator at its end makes no cell if there is one too many.
    fn cells(&self, line: &str) -> Vec<Range<usize>> {
        let mut cells = self.split(line);
        if cells.len() == self.dialect.columns + 1 && cells.last().is_some_and(Range::is_empty) {
            cells.pop();
        }
        cells
    }

    /// The first line that has numbers in as many cells as the rows have.
    fn first_row(&self, lines: &[Line<'_>]) -> Option<usize> {
        let Self { options, dialect, .. } = self;
        if let Some(count) = options.header_lines {
            let count = dialect::behind(lines, count);
            let at = lines[count..].iter().position(|line| is_row(*line, options))?;
            return Some(count + at);
        }
        let after = options.names_line.max(options.units_line).unwrap_or(0);
        lines.iter().position(|line| {
            let cells = self.split(line.text);
            let least = cells.len() - usize::from(cells.last().is_some_and(Range::is_empty));
            line.number > after
                && is_row(*line, options)
                && (least..=cells.len()).contains(&dialect.columns)
                && dialect::numbers_among(line.text, &cells, dialect.decimal).is_some()
        })
    }

    /// Whether the last column has a name and no values: a separator at the end of the rows is then
    /// not one too many.
    fn last_is_empty(&self, before: &[Line<'_>], rows: &[Line<'_>]) -> bool {
        let wider = |line: &Line<'_>| {
            let cells = self.split(line.text);
            (cells.len() == self.dialect.columns + 1)
                .then(|| cells.last().is_some_and(Range::is_empty))
        };
        let mut named = before.iter().filter(|line| is_row(**line, self.options));
        named.any(|line| wider(line) == Some(false)) && rows.first().and_then(wider) == Some(true)
    }

    /// The number of rows before the remarks at the end of a file: `"End of the test";"21.05.2026"`.
    /// They begin with a text, where the rows begin with a number or a time, and have no number.
    fn end_of_rows(&self, rows: &[Line<'_>]) -> usize {
        /// Most lines of remarks.
        const MOST: usize = 10;
        let decimal = self.dialect.decimal;
        let is_text = |word: &str| {
            numbers::read(word, decimal) == numbers::Cell::Other && stamps::read(word).is_none()
        };
        let begins_with_text = |line: &Line<'_>| {
            self.cells(line.text).first().is_some_and(|cell| is_text(&line.text[cell.clone()]))
        };
        let is_number = |word: &str| {
            !matches!(numbers::read(word, decimal), numbers::Cell::Other | numbers::Cell::Empty)
        };
        let is_remark = |line: &Line<'_>| {
            let cells = self.cells(line.text);
            let plain = !cells.iter().any(|cell| is_number(&line.text[cell.clone()]));
            begins_with_text(line) && (plain || cells.len() != self.dialect.columns)
        };
        let blank = |line: &Line<'_>| !is_row(*line, self.options);
        if rows.first().is_none_or(begins_with_text) {
            return rows.len();
        }
        let from = rows.len().saturating_sub(MOST);
        let last = rows[from..].iter().rposition(|line| !is_remark(line) && !blank(line));
        match last {
            Some(last) if rows[from + last + 1..].iter().any(is_remark) => from + last + 1,
            _ => rows.len(),
        }
    }

    /// An error at a place in a line.
    fn fault(
        &self,
        code: &'static str,
        says: String,
        line: Line<'_>,
        place: Range<usize>,
    ) -> Problem {
        error(code, says, &at(self.shown, line, place))
    }
}

/// The number that a text is; `None` if it is none, or may be two.
#[cfg(feature = "foreign")]
pub fn number(text: &str, options: &Options) -> Option<f64> {
    let read = |mark: DecimalMark| numbers::read(text.trim(), mark.letter());
    let marks = [DecimalMark::Point, DecimalMark::Comma];
    let marks = marks.into_iter().filter(|mark| options.decimal.is_none_or(|said| said == *mark));
    let mut found = None;
    for cell in marks.map(read) {
        match (cell, found) {
            (numbers::Cell::Number(number), None) => found = Some(number),
            (numbers::Cell::Number(number), Some(other)) if number == other => {}
            (numbers::Cell::Thousands(number), None) if options.decimal.is_some() => {
                found = Some(number)
            }
            (numbers::Cell::Number(_) | numbers::Cell::Thousands(_), _) => return None,
            _ => {}
        }
    }
    found
}

fn no_numbers(input: &Input<'_>, lines: &[Line<'_>]) -> Problem {
    let says = format!("`{}` has no rows of numbers", input.shown);
    let problem = Problem::error("no-numbers", says)
        .help("check whether this is the right file; say separator, decimal mark and number of header lines if they are unusual");
    match lines.iter().find(|line| is_row(**line, input.options)) {
        Some(line) => {
            problem.at(&at(input.shown, *line, 0..line.text.len())).label("the first line")
        }
        None => problem,
    }
}

/// A place in a line; only the part of a long line around it is kept.
fn at(shown: &str, line: Line<'_>, place: Range<usize>) -> Span {
    let (from, to) = decode::around(line.text, place.start);
    // Columns are counted from the start of the line, so that it is kept while it is short.
    let from = if place.start <= KEPT { 0 } else { from };
    let source = Source::excerpt(shown, &line.text[from..to], line.number);
    source.span(place.start - from..place.end.min(to) - from)
}

/// Places up to this byte of a line are shown with the whole start of the line.
const KEPT: usize = 400;
