//! The rows of a text table as columns of numbers.

use std::ops::Range;

use super::super::{Channel, Place, Table};
use super::dialect::{self, Dialect, Line};
use super::header::Heading;
use super::stamps::{self, DAY, NANOSECONDS, Stamp};
use super::{Text, at, numbers};
use crate::data::cells::shortened;
use crate::data::faults::Faults;
use crate::problem::Problem;
use crate::source::Span;

/// A column while it is read.
enum Column {
    /// No cell was filled so far: this many rows.
    Unknown(usize),
    Numbers(Vec<f64>),
    /// Stamps, `None` where empty.
    Stamps(Vec<Option<Stamp>>),
    /// Text, with the first of it.
    Text(String),
}

/// Reads the rows into the table.
pub(super) fn read(
    text: &Text<'_>,
    rows: &[Line<'_>],
    dialect: Dialect,
    headings: Vec<Heading>,
    table: &mut Table,
) -> Result<(), Vec<Problem>> {
    let mut columns: Vec<Column> = (0..dialect.columns).map(|_| Column::Unknown(0)).collect();
    let mut faults = Faults::new(text.shown);
    for line in rows.iter().filter(|line| super::is_row(text, **line)) {
        let found: Result<(), Problem> = row(text, *line, dialect).and_then(|cells| {
            let mut each = columns.iter_mut().zip(&headings).zip(cells);
            each.try_for_each(|((column, heading), cell)| {
                add(text, column, heading, *line, cell, dialect.decimal)
            })
        });
        if let Err(problem) = found {
            faults.push(|| problem);
        }
    }
    faults.finish(())?;
    let place = |column: usize, row: usize| {
        let line = *rows.iter().filter(|line| super::is_row(text, **line)).nth(row)?;
        let cell = self::row(text, line, dialect).ok()?.get(column)?.clone();
        Some((shortened(&line.text[cell.clone()]), at(text.shown, line, cell)))
    };
    finish(text, columns, headings, &place, table).map_err(|problem| vec![problem])
}

/// The cells of a row, as many as there are columns.
fn row(text: &Text<'_>, line: Line<'_>, dialect: Dialect) -> Result<Vec<Range<usize>>, Problem> {
    let mut cells = dialect::split(line.text, dialect.separator);
    if cells.len() == dialect.columns + 1 && cells.last().is_some_and(Range::is_empty) {
        cells.pop();
    }
    if cells.len() == dialect.columns {
        return Ok(cells);
    }
    if let Some(fixed) = fixed(line.text, dialect) {
        return Ok(fixed);
    }
    let place = match cells.get(dialect.columns) {
        Some(extra) => extra.start..line.text.len(),
        None => cells.last().cloned().unwrap_or(0..0),
    };
    let label =
        if cells.len() > dialect.columns { "beyond the last column" } else { "the last value" };
    let says = format!(
        "the row has {} values; the rows of this file have {}",
        cells.len(),
        dialect.columns
    );
    Err(Problem::error("ragged-row", says).at(&at(text.shown, line, place)).label(label))
}

/// Cells of fixed width, which may touch: `-1.500000E+03-1.380000E+03`.
fn fixed(line: &str, dialect: Dialect) -> Option<Vec<Range<usize>>> {
    let length = line.trim_end().len();
    if dialect.separator != dialect::Separator::Blanks
        || length == 0
        || !length.is_multiple_of(dialect.columns)
        || !line.is_ascii()
    {
        return None;
    }
    let width = length / dialect.columns;
    let cells = (0..dialect.columns).map(|column| {
        let cell = &line[column * width..(column + 1) * width];
        let start = column * width + cell.len() - cell.trim_start().len();
        (matches!(numbers::read(cell.trim(), dialect.decimal), numbers::Cell::Number(_)))
            .then(|| start..start + cell.trim().len())
    });
    cells.collect()
}

/// Adds a cell to a column.
fn add(
    text: &Text<'_>,
    column: &mut Column,
    heading: &Heading,
    line: Line<'_>,
    cell: Range<usize>,
    decimal: char,
) -> Result<(), Problem> {
    let word = &line.text[cell.clone()];
    if let Column::Unknown(empty) = column {
        match numbers::read(word, decimal) {
            numbers::Cell::Empty => {
                *empty += 1;
                return Ok(());
            }
            numbers::Cell::Other => match stamps::read(word) {
                Some(_) => *column = Column::Stamps(vec![None; *empty]),
                None => *column = Column::Text(shortened(word)),
            },
            _ => *column = Column::Numbers(vec![f64::NAN; *empty]),
        }
    }
    let (code, fact, help) = match column {
        Column::Unknown(_) | Column::Text(_) => return Ok(()),
        Column::Stamps(found) => {
            let stamp = if word.is_empty() { Some(None) } else { stamps::read(word).map(Some) };
            let Some(stamp) = stamp else {
                let says = format!(
                    "`{}`: `{}` is not a time stamp as in the rows before",
                    heading.name,
                    shortened(word)
                );
                return Err(Problem::error("not-a-number", says).at(&at(text.shown, line, cell)));
            };
            found.push(stamp);
            return Ok(());
        }
        Column::Numbers(found) => match numbers::read(word, decimal) {
            numbers::Cell::Number(number) => {
                found.push(number);
                return Ok(());
            }
            numbers::Cell::Empty => {
                found.push(f64::NAN);
                return Ok(());
            }
            numbers::Cell::Thousands => (
                "thousands",
                "has marks between its thousands",
                "export the numbers without them: they cannot be told from decimal marks",
            ),
            numbers::Cell::NotFinite => (
                "not-finite",
                "is not a finite number",
                "leave the cell empty where there is no value",
            ),
            numbers::Cell::Other if word.matches([',', '.']).count() == 1 => (
                "decimal-comma",
                "has another decimal mark than the rows before",
                "name the decimal mark, or export the file again",
            ),
            numbers::Cell::Other => (
                "not-a-number",
                "is not a number",
                "name the mark of comments or the number of header lines",
            ),
        },
    };
    Err(Problem::error(code, format!("`{}`: `{}` {fact}", heading.name, shortened(word)))
        .at(&at(text.shown, line, cell))
        .help(help))
}

/// Columns of numbers and times as channels. `cell`: the text and the place of a cell, by its
/// column and row.
fn finish(
    text: &Text<'_>,
    columns: Vec<Column>,
    headings: Vec<Heading>,
    cell: &dyn Fn(usize, usize) -> Option<(String, Span)>,
    table: &mut Table,
) -> Result<(), Problem> {
    // A date in one column and the time of the day in another belong together.
    let has_clock =
        columns.iter().any(|column| matches!(column, Column::Stamps(found) if only_clock(found)));
    let day = columns.iter().position(
        |column| matches!(column, Column::Stamps(found) if has_clock && only_dates(found)),
    );
    let days: Option<Vec<Option<Stamp>>> = day.and_then(|at| match &columns[at] {
        Column::Stamps(found) => Some(found.clone()),
        _ => None,
    });
    for (index, (column, heading)) in columns.into_iter().zip(headings).enumerate() {
        let place = Place { column: index + 1, span: heading.span.clone() };
        let (values, unit, comment) = match column {
            Column::Numbers(values) => (values, heading.unit, heading.comment),
            Column::Stamps(_) if day == Some(index) => {
                table.left_out.push((heading.name, "its dates are part of the times".into()));
                continue;
            }
            Column::Stamps(mut stamps) => {
                let dated = days.as_ref().filter(|_| only_clock(&stamps));
                let of_dates = day.filter(|_| dated.is_some()).unwrap_or(index);
                if let Some(days) = dated {
                    for (stamp, day) in stamps.iter_mut().zip(days) {
                        *stamp = stamp
                            .zip(*day)
                            .map(|(stamp, day)| Stamp { date: day.date, clock: stamp.clock });
                    }
                }
                let ambiguous = || {
                    let says = format!(
                        "the dates of `{}` can be read with the day or with the month first",
                        heading.name
                    );
                    let problem = Problem::error("date-order", says)
                        .help("state the order in the mapping: `format: {dates: dmy}` or `format: {dates: mdy}`");
                    match &heading.span {
                        Some(span) => problem.at(span),
                        None => problem,
                    }
                };
                let values = seconds(text, &stamps).ok_or_else(ambiguous)?;
                // Without a date of the calendar, a stamp has no value.
                let wrong = stamps
                    .iter()
                    .zip(&values)
                    .position(|(stamp, value)| stamp.is_some() && value.is_nan());
                if let Some((written, span)) = wrong.and_then(|row| cell(of_dates, row)) {
                    let says =
                        format!("`{}`: `{written}` has no date of the calendar", heading.name);
                    return Err(Problem::error("not-a-date", says).at(&span));
                }
                (
                    values,
                    Some("s".to_string()),
                    Some("seconds from the first time stamp".to_string()),
                )
            }
            Column::Text(first) => {
                table
                    .left_out
                    .push((heading.name, format!("its cells are text, such as `{first}`")));
                continue;
            }
            Column::Unknown(_) => {
                table.left_out.push((heading.name, "its cells are empty".into()));
                continue;
            }
        };
        table.channels.push(Channel { name: heading.name, unit, comment, values, place });
    }
    if table.channels.is_empty() {
        return Err(Problem::error(
            "no-numbers",
            format!("`{}` has no column of numbers", text.shown),
        ));
    }
    Ok(())
}

fn only_clock(stamps: &[Option<Stamp>]) -> bool {
    stamps.iter().flatten().all(|stamp| stamp.date.is_none() && stamp.clock.is_some())
}

fn only_dates(stamps: &[Option<Stamp>]) -> bool {
    stamps.iter().flatten().all(|stamp| stamp.date.is_some() && stamp.clock.is_none())
}

/// Seconds from the first stamp; `None` if the order of day and month is not known.
fn seconds(text: &Text<'_>, stamps: &[Option<Stamp>]) -> Option<Vec<f64>> {
    let dates: Vec<stamps::Date> = stamps.iter().flatten().filter_map(|stamp| stamp.date).collect();
    let order = stamps::order(&dates, text.options).ok()?;
    let (mut first, mut before, mut nights) = (None, None, 0);
    let values = stamps.iter().map(|stamp| {
        let Some(stamp) = stamp else { return f64::NAN };
        let clock = stamp.clock.unwrap_or(0);
        let Some(day) = stamp.date.map_or(Some(0), |date| stamps::days(&date, order)) else {
            return f64::NAN;
        };
        // A time of the day alone goes back at midnight.
        if stamp.date.is_none() && before.is_some_and(|before| before - clock > DAY / 2) {
            nights += 1;
        }
        before = Some(clock);
        let time = (day + nights) * DAY + clock;
        (time - *first.get_or_insert(time)) as f64 / NANOSECONDS as f64
    });
    Some(values.collect())
}

/// Texts as seconds from the first of them, if all that are filled are time stamps.
#[cfg(feature = "foreign")]
pub(in crate::foreign) fn stamps_from_first(
    cells: &[&str],
    options: &super::Options,
    shown: &str,
) -> Option<Vec<f64>> {
    let read = |cell: &&str| {
        if cell.trim().is_empty() { Some(None) } else { stamps::read(cell.trim()).map(Some) }
    };
    let found: Option<Vec<Option<Stamp>>> = cells.iter().map(read).collect();
    seconds(&Text { shown, options }, &found.filter(|found| found.iter().any(Option::is_some))?)
}
