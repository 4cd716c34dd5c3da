//! Text tables of any dialect: CSV, and the ASCII exports of simulation programs.
//!
//! | file | content |
//! |---|---|
//! | `mod` | a text as a table: header, rows, columns |
//! | `decode` | encodings |
//! | `dialect` | lines, cells, separator and decimal mark |
//! | `header` | names, units, list of channels, facts |
//! | `numbers`, `stamps` | a cell as a number or a time |

mod decode;
mod dialect;
mod header;
mod numbers;
mod stamps;
mod values;

use std::ops::Range;

pub(in crate::foreign) use decode::wide;
pub use dialect::{DecimalMark, Separator};
use dialect::{Dialect, Line};
pub(in crate::foreign) use header::name_and_unit;
#[cfg(feature = "foreign")]
pub(in crate::foreign) use header::{most_are_units, unbracketed};
pub use stamps::DateOrder;
#[cfg(feature = "foreign")]
pub(in crate::foreign) use values::stamps_from_first;

use super::load::Budget;
use super::{Format, Input, Options, Read, Table};
use crate::problem::Problem;
use crate::source::{Source, Span};
use crate::yaml::Words;

/// Maximum length of a line in bytes, as for a record of a campaign.
const LONGEST_LINE: usize = 1 << 20;

/// What the parts of the reader share.
struct Text<'a> {
    shown: &'a str,
    options: &'a Options,
}

/// Reads a text table.
pub(super) fn read(input: &Input<'_>, format: Format) -> Result<Read, Vec<Problem>> {
    let (shown, options) = (input.shown, input.options);
    if options.separator.is_some_and(|separator| {
        options.decimal.is_some_and(|mark| separator == Separator::Mark(mark.letter()))
    }) {
        return Err(vec![Problem::error(
            "dialect",
            "the separator and the decimal mark are the same",
        )]);
    }
    let (content, encoding) = decode::text(input.bytes, options.encoding.as_deref(), shown)?;
    let lines = dialect::lines(&content);
    if let Some(line) = lines.iter().find(|line| line.text.len() > LONGEST_LINE) {
        let says =
            format!("line {} of `{shown}` has more than {} MB", line.number, LONGEST_LINE >> 20);
        return Err(vec![
            Problem::error("line-too-long", says)
                .at(&at(shown, *line, 0..0))
                .help("export one line per sample"),
        ]);
    }
    let text = Text { shown, options };
    let mut dialect =
        dialect::detect(&lines, options).ok_or_else(|| vec![no_numbers(&text, &lines)])?;
    let start = first_row(&text, &lines, dialect).ok_or_else(|| vec![no_numbers(&text, &lines)])?;
    let (before, rows) = lines.split_at(start);
    dialect.columns += usize::from(last_is_empty(&text, before, rows, dialect));
    let header = header::read(&text, before, dialect)?;
    Budget::new(input.bytes.len(), shown).take(dialect.columns, rows.len(), "the table")?;
    let mut table = Table {
        facts: header.facts,
        first_row: rows.first().map_or(1, |line| line.number),
        ..Table::default()
    };
    values::read(&text, rows, dialect, header.columns, &mut table)?;
    let facts = vec![
        ("encoding".into(), encoding.into()),
        ("separator".into(), dialect.separator.words()),
        ("decimal mark".into(), format!("`{}`", dialect.decimal)),
        ("first line of numbers".into(), table.first_row.to_string()),
        ("form".into(), format.word().into()),
    ];
    Ok(Read { tables: vec![table], facts })
}

/// The first line that has numbers in as many cells as the rows have.
fn first_row(text: &Text<'_>, lines: &[Line<'_>], dialect: Dialect) -> Option<usize> {
    let options = text.options;
    if let Some(count) = options.header_lines {
        return lines
            .get(count..)?
            .iter()
            .position(|line| is_row(text, *line))
            .map(|at| count + at);
    }
    let after = options.names_line.max(options.units_line).unwrap_or(0);
    lines.iter().position(|line| {
        let cells = dialect::split(line.text, dialect.separator);
        let count = if cells.last().is_some_and(Range::is_empty) {
            cells.len() - 1..=cells.len()
        } else {
            cells.len()..=cells.len()
        };
        line.number > after
            && is_row(text, *line)
            && count.contains(&dialect.columns)
            && dialect::numbers_among(line.text, &cells, dialect.decimal).is_some()
    })
}

/// Whether the last column has a name and no values: a separator at the end of the rows is then not
/// one too many.
fn last_is_empty(
    text: &Text<'_>,
    before: &[Line<'_>],
    rows: &[Line<'_>],
    dialect: Dialect,
) -> bool {
    let wider = |line: &Line<'_>| {
        let cells = dialect::split(line.text, dialect.separator);
        (cells.len() == dialect.columns + 1).then(|| cells.last().is_some_and(Range::is_empty))
    };
    let named =
        before.iter().filter(|line| is_row(text, **line)).any(|line| wider(line) == Some(false));
    named && rows.first().and_then(wider) == Some(true)
}

/// Whether a line can be a row: neither blank nor a comment.
fn is_row(text: &Text<'_>, line: Line<'_>) -> bool {
    !line.text.trim().is_empty() && dialect::comment(line.text, text.options).is_none()
}

fn no_numbers(text: &Text<'_>, lines: &[Line<'_>]) -> Problem {
    let says = format!("`{}` has no rows of numbers", text.shown);
    let problem = Problem::error("no-numbers", says)
        .help("check whether this is the right file; say separator, decimal mark and number of header lines if they are unusual");
    match lines.iter().find(|line| is_row(text, **line)) {
        Some(line) => {
            problem.at(&at(text.shown, *line, 0..line.text.len())).label("the first line")
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
