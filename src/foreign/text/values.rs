//! The rows of a text table as columns of numbers.

use std::ops::Range;

use super::Text;
use super::dialect::{Line, is_row};
use super::header::Heading;
use super::numbers::{self, Marks};
use super::stamps::{self, DAY, Stamp, Unclear};
use crate::data::cells::shortened;
use crate::data::faults::Faults;
use crate::foreign::{Channel, NANOSECONDS, Options, Table};
use crate::problem::Problem;

/// A column while it is read.
enum Column {
    /// No cell was filled so far: this many rows.
    Unknown(usize),
    Numbers(Vec<f64>, Marks),
    /// Places on a line in metres, written as kilometres and metres.
    Chainage(Vec<f64>),
    /// Stamps, `None` where empty.
    Stamps(Vec<Option<Stamp>>),
    /// Text, with the first of it.
    Text(String),
}

/// A cell that does not belong into its column: a code, what is wrong with it, and a help.
type Unfit = (&'static str, &'static str, Option<&'static str>);

impl Column {
    /// Adds the cell of a row.
    fn add(&mut self, row: usize, word: &str, text: &Text<'_>) -> Result<(), Unfit> {
        let decimal = text.dialect.decimal;
        if let Self::Unknown(empty) = self {
            match numbers::read(word, decimal) {
                numbers::Cell::Empty => {
                    *empty += 1;
                    return Ok(());
                }
                numbers::Cell::Other => match stamps::read(word) {
                    Some(_) => *self = Self::Stamps(vec![None; *empty]),
                    None => *self = Self::Text(shortened(word)),
                },
                numbers::Cell::Chainage(_) => *self = Self::Chainage(vec![f64::NAN; *empty]),
                _ => *self = Self::Numbers(vec![f64::NAN; *empty], Marks::default()),
            }
        }
        match self {
            Self::Unknown(_) | Self::Text(_) => {}
            Self::Chainage(found) => found.push(match numbers::read(word, decimal) {
                numbers::Cell::Chainage(metres) => metres,
                numbers::Cell::Empty => f64::NAN,
                _ => {
                    let says = "is not kilometres and metres as in the rows before";
                    return Err(("not-a-number", says, None));
                }
            }),
            Self::Stamps(found) if word.is_empty() => found.push(None),
            Self::Stamps(found) => {
                let says = "is not a time stamp as in the rows before";
                found.push(Some(stamps::read(word).ok_or(("not-a-number", says, None))?));
            }
            Self::Numbers(found, marks) => {
                let number = match numbers::read(word, decimal) {
                    numbers::Cell::Number(number) => number,
                    numbers::Cell::Empty => f64::NAN,
                    // A decimal mark that is stated leaves no question.
                    numbers::Cell::Thousands(number) if text.options.decimal.is_some() => number,
                    other => return Err(unfit(other, word)),
                };
                marks.see(row, word, decimal);
                found.push(number);
            }
        }
        Ok(())
    }
}

/// Help where a mark can be read in two ways.
const DECIMAL: &str =
    "say in the mapping what the decimal mark is: `format: {decimal: comma}` or `{decimal: point}`";

/// A cell that is no number among numbers.
fn unfit(cell: numbers::Cell, word: &str) -> Unfit {
    let (code, says, help) = match cell {
        numbers::Cell::Thousands(_) => (
            "thousands",
            "has marks between its thousands, or another decimal mark than other numbers",
            DECIMAL,
        ),
        numbers::Cell::NotFinite => {
            ("not-finite", "is not a finite number", "leave the cell empty where there is no value")
        }
        _ if word.matches([',', '.']).count() == 1 => (
            "decimal-comma",
            "has another decimal mark than the rows before",
            "name the decimal mark, or export the file again",
        ),
        _ => (
            "not-a-number",
            "is not a number",
            "name the mark of comments or the number of header lines",
        ),
    };
    (code, says, Some(help))
}

/// Reads the rows into the table.
pub fn read(
    text: &Text<'_>,
    rows: &[Line<'_>],
    headings: Vec<Heading>,
    table: &mut Table,
) -> Result<(), Vec<Problem>> {
    let rows: Vec<Line<'_>> =
        rows.iter().filter(|line| is_row(**line, text.options)).copied().collect();
    let mut columns: Vec<Column> = (0..text.dialect.columns).map(|_| Column::Unknown(0)).collect();
    let mut faults = Faults::new(text.shown);
    for (number, line) in rows.iter().enumerate() {
        let found = row(text, *line).and_then(|cells| {
            let mut each = columns.iter_mut().zip(&headings).zip(cells);
            each.try_for_each(|((column, heading), cell)| {
                let word = &line.text[cell.clone()];
                column.add(number, word, text).map_err(|(code, fact, help)| {
                    let says = format!("`{}`: `{}` {fact}", heading.name, shortened(word));
                    text.fault(code, says, *line, cell).help_if(help)
                })
            })
        });
        if let Err(problem) = found {
            faults.push(|| problem);
        }
    }
    for (index, (column, heading)) in columns.iter().zip(&headings).enumerate() {
        let Column::Numbers(_, marks) = column else { continue };
        let unclear = marks.unclear().filter(|_| text.options.decimal.is_none());
        let place =
            unclear.and_then(|at| Some((rows[at], row(text, rows[at]).ok()?[index].clone())));
        if let Some((line, cell)) = place {
            let (name, word) = (&heading.name, shortened(&line.text[cell.clone()]));
            let says = format!(
                "`{name}`: `{word}` may have a decimal mark or one between thousands: its column has numbers below 1000 without a mark as well"
            );
            faults.push(|| text.fault("thousands", says, line, cell).help(DECIMAL));
        }
    }
    faults.finish(())?;
    Ok(finish(text, &rows, columns, headings, table)?)
}

/// The cells of a row, as many as there are columns.
fn row(text: &Text<'_>, line: Line<'_>) -> Result<Vec<Range<usize>>, Problem> {
    let (cells, wanted) = (text.cells(line.text), text.dialect.columns);
    if cells.len() == wanted {
        return Ok(cells);
    }
    let place = match cells.get(wanted) {
        Some(extra) => extra.start..line.text.len(),
        None => cells.last().cloned().unwrap_or(0..0),
    };
    let label = if cells.len() > wanted { "beyond the last column" } else { "the last value" };
    let says = format!("the row has {} values; the rows of this file have {wanted}", cells.len());
    Err(text.fault("ragged-row", says, line, place).label(label))
}

/// Columns of numbers and times as channels.
fn finish(
    text: &Text<'_>,
    rows: &[Line<'_>],
    columns: Vec<Column>,
    headings: Vec<Heading>,
    table: &mut Table,
) -> Result<(), Problem> {
    // A date in one column and the time of the day in another belong together.
    let has_clock =
        columns.iter().any(|column| matches!(column, Column::Stamps(found) if only_clock(found)));
    let days = columns.iter().enumerate().find_map(|(at, column)| match column {
        Column::Stamps(found) if has_clock && only_dates(found) => Some((at, found.clone())),
        _ => None,
    });
    for (index, (column, heading)) in columns.into_iter().zip(headings).enumerate() {
        let name = heading.name.clone();
        let channel = match column {
            Column::Numbers(values, _) => {
                let Heading { unit, other_unit, comment, .. } = heading;
                Ok(Channel { values, unit, other_unit, comment, ..Channel::default() })
            }
            Column::Chainage(values) => {
                let comment = Some("kilometres and metres".to_string());
                let unit = Some("m".to_string());
                Ok(Channel { values, unit, comment, ..Channel::default() })
            }
            Column::Stamps(_) if days.as_ref().is_some_and(|(day, _)| *day == index) => {
                Err("its dates are part of the times".into())
            }
            Column::Stamps(mut stamps) => {
                let mut of_dates = index;
                if let Some((day, days)) = days.as_ref().filter(|_| only_clock(&stamps)) {
                    of_dates = *day;
                    for (stamp, day) in stamps.iter_mut().zip(days) {
                        *stamp =
                            stamp.zip(*day).map(|(stamp, day)| Stamp { date: day.date, ..stamp });
                    }
                }
                let (values, since) = times(text, rows, &stamps, of_dates, &heading)?;
                let comment = Some("seconds from the first time stamp".to_string());
                let unit = Some("s".to_string());
                Ok(Channel { values, since, unit, comment, ..Channel::default() })
            }
            Column::Text(first) => Err(format!("its cells are text, such as `{first}`")),
            Column::Unknown(_) => Err("its cells are empty".into()),
        };
        match channel {
            Ok(channel) => table.channels.push(Channel { name, ..channel }),
            Err(why) => table.left_out.push((name, why)),
        }
    }
    if table.channels.is_empty() {
        let says = format!("`{}` has no column of numbers", text.shown);
        return Err(Problem::error("no-numbers", says));
    }
    Ok(())
}

/// Seconds from the first stamp, and that stamp in ns.
pub type Times = (Vec<f64>, Option<i64>);

/// The times of the stamps of a column; `of_dates`: the column that their dates are from.
fn times(
    text: &Text<'_>,
    rows: &[Line<'_>],
    stamps: &[Option<Stamp>],
    of_dates: usize,
    Heading { name, span, .. }: &Heading,
) -> Result<Times, Problem> {
    let (values, since) = seconds(text.options, stamps).map_err(|unclear| {
        let (code, can, help) = match unclear {
            Unclear::Order => (
                "date-order",
                format!("the dates of `{name}` can be read with the day or with the month first"),
                "state the order in the mapping: `format: {dates: dmy}` or `format: {dates: mdy}`",
            ),
            Unclear::Clock => ("clock-form", format!("the times of `{name}` {CLOCK}"), CLOCK_HELP),
        };
        let problem = Problem::error(code, can).help(help);
        match span {
            Some(span) => problem.at(span),
            None => problem,
        }
    })?;
    // Without a date of the calendar, a stamp has no value.
    let wrong = stamps
        .iter()
        .zip(&values)
        .position(|(stamp, value)| stamp.is_some() && value.is_nan())
        .and_then(|at| Some((rows[at], row(text, rows[at]).ok()?.get(of_dates)?.clone())));
    match wrong {
        Some((line, cell)) => {
            let written = shortened(&line.text[cell.clone()]);
            let says = format!("`{name}`: `{written}` has no date of the calendar");
            Err(text.fault("not-a-date", says, line, cell))
        }
        None => Ok((values, since)),
    }
}

fn only_clock(stamps: &[Option<Stamp>]) -> bool {
    stamps.iter().flatten().all(|stamp| stamp.date.is_none() && stamp.clock.is_some())
}

fn only_dates(stamps: &[Option<Stamp>]) -> bool {
    stamps.iter().flatten().all(|stamp| stamp.date.is_some() && stamp.clock.is_none())
}

const CLOCK: &str = "can be hours and minutes, or minutes and seconds";
const CLOCK_HELP: &str =
    "state it in the mapping: `format: {clock: mm:ss}` or `format: {clock: hh:mm}`";

/// The times of stamps.
///
/// # Errors
/// What is not known of them.
fn seconds(options: &Options, stamps: &[Option<Stamp>]) -> Result<Times, Unclear> {
    let dates: Vec<stamps::Date> = stamps.iter().flatten().filter_map(|stamp| stamp.date).collect();
    let order = stamps::order(&dates, options).map_err(|()| Unclear::Order)?;
    let mut stamps = stamps.to_vec();
    stamps::settle(&mut stamps, options)?;
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
    let values = values.collect();
    Ok((values, first))
}

/// The times of texts, if all that are filled are time stamps.
///
/// # Errors
/// Why the column is left out.
#[cfg(feature = "foreign")]
pub fn stamps_from_first(cells: &[&str], options: &Options) -> Result<Times, String> {
    let read = |cell: &&str| {
        if cell.trim().is_empty() { Some(None) } else { stamps::read(cell.trim()).map(Some) }
    };
    let found: Option<Vec<Option<Stamp>>> = cells.iter().map(read).collect();
    let found = found.filter(|found| found.iter().any(Option::is_some));
    seconds(options, &found.ok_or("its cells are text")?).map_err(|unclear| match unclear {
        Unclear::Order => {
            "its dates can be read with the day or with the month first: `format: {dates: dmy}`"
                .into()
        }
        Unclear::Clock => format!("its times {CLOCK}: {CLOCK_HELP}"),
    })
}
