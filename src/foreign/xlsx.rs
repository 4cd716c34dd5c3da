//! Excel workbooks: each sheet with rows of numbers is a table, with names in one row and units in
//! the next.

use std::io::{Cursor, Read as _};

use calamine::{DataRef, Reader, Xlsx, XlsxError};

use super::guard::Failure;
use super::load::{Budget, most_unpacked};
use super::text::{
    self, most_are_units, name_and_unit, over_two_rows, stamps_from_first, unbracketed,
};
use super::{Channel, Input, Options, Read, Table, conflict, filled};
use crate::problem::Problem;

/// Columns of a sheet.
const COLUMNS: u32 = 16_384;
const SECONDS_A_DAY: f64 = 86_400.0;
/// Steps of a second to which times are rounded, and the nanoseconds of one: Excel shows
/// milliseconds, and its days resolve 0.6 µs today.
const STEPS: f64 = 1e5;
const STEP: i64 = 10_000;
/// 1970-01-01 in the days of Excel.
const EPOCH: f64 = 25_569.0;
/// Maximum number of facts of a sheet without a table, and of cells of a header that are looked at.
const MOST_FACTS: usize = 100;

#[derive(Clone, Debug, PartialEq)]
enum Cell {
    Number(f64),
    /// A date or time as days.
    Days(f64),
    Text(String),
}

/// The filled cells of a row: column and content, from the left.
type Row = (u32, Vec<(u32, Cell)>);

/// The sheets of a workbook as tables.
pub fn read(input: &Input<'_>) -> Result<Read, Vec<Problem>> {
    unpacks(input)?;
    let mut book: Xlsx<_> = Xlsx::new(Cursor::new(&input.bytes[..]))
        .map_err(|error| input.damaged("the workbook", error))?;
    let mut budget = input.budget();
    let mut read = Read::default();
    for name in book.sheet_names() {
        let place = format!("sheet `{name}`");
        let rows = rows(&mut book, &name, &mut budget, &place)
            .map_err(|failure| input.failed(&place, failure))?;
        // A chart or a macro.
        let Some(rows) = rows else { continue };
        match table(input, &name, rows, &mut budget)? {
            Ok(table) => read.tables.push(table),
            Err(facts) => {
                read.facts.push((place, "no rows of numbers".into()));
                read.facts.extend(facts);
            }
        }
    }
    if read.tables.is_empty() {
        let says = format!("`{}` has no sheet with rows of numbers", input.shown);
        return Err(Problem::error("no-numbers", says).into());
    }
    Ok(read)
}

/// Unpacks every part once to count its bytes: what a part declares is not what it holds.
fn unpacks(input: &Input<'_>) -> Result<(), Problem> {
    let mut archive = zip::ZipArchive::new(Cursor::new(&input.bytes[..]))
        .map_err(|error| input.damaged("the list of its parts", error))?;
    let mut left = most_unpacked(input.bytes.len()) as u64;
    for index in 0..archive.len() {
        let number = format!("{}", index + 1);
        let part = archive
            .by_index(index)
            .map_err(|error| input.damaged(&format!("part {number}"), error))?;
        let name = part.name().map_or(number, |name| name.into_owned());
        let place = format!("part `{name}`");
        let size = std::io::copy(&mut part.take(left + 1), &mut std::io::sink())
            .map_err(|error| input.damaged(&place, error))?;
        left = left.checked_sub(size).ok_or_else(|| input.failed(&place, Failure::Unpacked))?;
    }
    Ok(())
}

/// The filled cells of a sheet; `None` if it is not a sheet of cells. They are streamed: a sheet
/// may declare a range of 17 thousand million cells.
fn rows(
    book: &mut Xlsx<Cursor<&[u8]>>,
    name: &str,
    budget: &mut Budget<'_>,
    place: &str,
) -> Result<Option<Vec<Row>>, Failure> {
    let mut reader = match book.worksheet_cells_reader(name) {
        Ok(reader) => reader,
        Err(XlsxError::NotAWorksheet(_)) => return Ok(None),
        Err(error) => return Err(error.to_string().into()),
    };
    let mut rows: Vec<Row> = Vec::new();
    loop {
        let last = rows.last().map_or(0, |(row, _)| row + 1);
        let next = reader.next_cell().map_err(|error| format!("after row {last}: {error}"))?;
        let Some(cell) = next else { return Ok(Some(rows)) };
        let (row, column) = cell.get_position();
        let content = match cell.get_value() {
            DataRef::Int(number) => Cell::Number(*number as f64),
            DataRef::Float(number) => Cell::Number(*number),
            DataRef::Bool(yes) => Cell::Number(f64::from(u8::from(*yes))),
            DataRef::DateTime(time) => Cell::Days(time.as_f64()),
            DataRef::String(text) | DataRef::DateTimeIso(text) | DataRef::DurationIso(text) => {
                Cell::Text(text.clone())
            }
            DataRef::SharedString(text) => Cell::Text((*text).to_string()),
            // #N/A and #DIV/0!: there is no value.
            DataRef::Error(_) | DataRef::Empty => continue,
        };
        if content.text().is_some_and(|text| text.trim().is_empty()) {
            continue;
        }
        if column >= COLUMNS {
            return Err(format!("row {}: a cell in column {}", row + 1, column + 1).into());
        }
        // A cell with its text takes as much as several numbers.
        budget.add(CELL, place)?;
        match rows.last_mut() {
            Some((last, cells)) if *last == row => cells.push((column, content)),
            Some((last, _)) if *last > row => {
                return Err(format!("row {} follows row {}", row + 1, *last + 1).into());
            }
            _ => rows.push((row, vec![(column, content)])),
        }
    }
}

impl Cell {
    fn text(&self) -> Option<&str> {
        if let Self::Text(text) = self { Some(text) } else { None }
    }

    fn words(&self) -> String {
        match self {
            Self::Number(number) | Self::Days(number) => number.to_string(),
            Self::Text(text) => text.trim().to_string(),
        }
    }
}

/// Values of eight bytes that a cell takes.
const CELL: usize = size_of::<(u32, Cell)>() / 8;

/// The table of a sheet, or the facts of a sheet without one.
fn table(
    input: &Input<'_>,
    name: &str,
    rows: Vec<Row>,
    budget: &mut Budget<'_>,
) -> Result<Result<Table, Vec<(String, String)>>, Problem> {
    let options = input.options;
    let numeric = |row: &Row| {
        let numbers = row.1.iter().filter(|(_, cell)| cell.text().is_none()).count();
        numbers > 0 && 2 * numbers >= row.1.len()
    };
    // Rows of numbers come one after the other; a number beside a text in a preamble is not one.
    let after = options.names_line.max(options.units_line).max(options.header_lines).unwrap_or(0);
    let widest = rows.iter().filter(|row| numeric(row)).map(|row| row.1.len()).max().unwrap_or(0);
    let start = rows
        .iter()
        .position(|row| row.0 as usize >= after && numeric(row) && 2 * row.1.len() >= widest);
    let Some(start) = start.filter(|start| {
        widest > 1 || rows.len() > start + 1 && rows[*start + 1..].iter().all(numeric)
    }) else {
        return Ok(Err(pairs(name, &rows)));
    };
    let (before, data) = rows.split_at(start);
    // A cover sheet: names with a number each, without headings.
    let is_pair = |row: &Row| matches!(row.1[..], [(_, Cell::Text(_)), (_, Cell::Number(_))]);
    if data.iter().all(is_pair) && before.iter().all(|row| row.1.len() < 2) {
        return Ok(Err(pairs(name, &rows)));
    }
    let Headers { names, units, above } = headers(input, name, before, data[0].0, widest)?;
    let heading = |row: Option<&Row>, column: u32| {
        let (_, cell) = row?.1.iter().find(|(other, _)| *other == column)?;
        filled(&cell.words())
    };
    let mut columns: Vec<u32> =
        data.iter().flat_map(|row| row.1.iter().map(|(column, _)| *column)).collect();
    columns.sort_unstable();
    columns.dedup();
    budget.take(columns.len(), data.len(), &format!("sheet `{name}`"))?;
    let mut table = Table {
        name: name.to_string(),
        first_row: data[0].0 as usize + 1,
        rows: data.len(),
        facts: pairs(name, before),
        ..Table::default()
    };
    let mut cells: Vec<Vec<Option<&Cell>>> = vec![vec![None; data.len()]; columns.len()];
    for (at, (_, row)) in data.iter().enumerate() {
        for (column, cell) in row {
            if let Ok(index) = columns.binary_search(column) {
                cells[index][at] = Some(cell);
            }
        }
    }
    let named = |row: Option<&Row>| columns.iter().map(|column| heading(row, *column)).collect();
    let (lower, upper): (Vec<_>, Vec<_>) = (named(names), named(above));
    let called = over_two_rows(&upper, &lower);
    for ((column, cells), called) in columns.iter().copied().zip(cells).zip(called) {
        let (called, unit) = called.map_or_else(
            || (format!("column {}", letters(column)), None),
            |text| name_and_unit(&text),
        );
        let of_row = heading(units, column).and_then(|text| unbracketed(&text));
        let other_unit = conflict(of_row.as_deref(), unit.clone());
        let unit = of_row.or(unit);
        let found = values(options, &cells).map_err(|(at, text)| {
            let cell = format!("{}{}", letters(column), data[at].0 + 1);
            let says = format!(
                "`{}`, sheet `{name}`, cell {cell}: `{text}` is not a number as in the rows before",
                input.shown
            );
            Problem::error("not-a-number", says).help("correct the cell, or leave it empty")
        })?;
        let (values, since) = match found {
            Ok(found) => found,
            Err(why) => {
                table.left_out.push((called, why));
                continue;
            }
        };
        table.channels.push(Channel {
            name: called,
            unit: if since.is_some() { Some("s".into()) } else { unit },
            other_unit: other_unit.filter(|_| since.is_none()),
            comment: since.map(|_| "seconds from the first time".into()),
            values,
            since,
        });
    }
    Ok(Ok(table))
}

/// The rows with the names and the units of the columns, where there are any.
struct Headers<'a> {
    names: Option<&'a Row>,
    units: Option<&'a Row>,
    /// The row right above the names, if it has texts alone.
    above: Option<&'a Row>,
}

/// The headers among the rows before the first row of numbers; a row of them is at least half as
/// wide as the widest of numbers.
///
/// # Errors
/// `header-line`.
fn headers<'a>(
    input: &Input<'_>,
    name: &str,
    before: &'a [Row],
    first: u32,
    widest: usize,
) -> Result<Headers<'a>, Problem> {
    let named = |number: usize, what: &str| {
        let row = before.iter().find(|row| row.0 as usize + 1 == number);
        row.ok_or_else(|| {
            let says =
                format!("row {number} of sheet `{name}` of `{}`, said to have the {what}, is empty or among the numbers", input.shown);
            Problem::error("header-line", says).help(format!("the numbers begin in row {}", first + 1))
        })
    };
    let are_units = |row: &&&Row| {
        let texts: Vec<String> = row.1.iter().map(|(_, cell)| cell.words()).collect();
        most_are_units(texts.iter().map(String::as_str))
    };
    let full: Vec<&Row> = before.iter().filter(|row| 2 * row.1.len() >= widest).collect();
    let units = match input.options.units_line {
        Some(0) => None,
        Some(number) => Some(named(number, "units")?),
        None => full.iter().skip(1).rev().find(are_units).copied(),
    };
    let names = match input.options.names_line {
        Some(number) => Some(named(number, "names")?),
        None => full.iter().rev().find(|row| units.is_none_or(|units| row.0 < units.0)).copied(),
    };
    let above = names.filter(|_| input.options.names_line.is_none()).and_then(|names| {
        let above = before.iter().find(|row| row.0 + 1 == names.0)?;
        above.1.iter().all(|(_, cell)| cell.text().is_some()).then_some(above)
    });
    Ok(Headers { names, units, above })
}

/// The values of a column; of times seconds from the first, and that one in ns since 1970.
type Numbers = (Vec<f64>, Option<i64>);

/// The numbers of a column, or why it is left out.
///
/// # Errors
/// A text among numbers, with its row.
fn values(
    options: &Options,
    cells: &[Option<&Cell>],
) -> Result<Result<Numbers, String>, (usize, String)> {
    let there = || cells.iter().flatten();
    let are_texts =
        |first: &Cell| first.text().is_some_and(|text| text::number(text, options).is_none());
    if there().next().is_none_or(|first| are_texts(first)) {
        let texts: Vec<&str> =
            cells.iter().map(|cell| cell.and_then(Cell::text).unwrap_or("")).collect();
        let times = stamps_from_first(&texts, options);
        let all = there().all(|cell| cell.text().is_some());
        return Ok(times.and_then(|times| all.then_some(times).ok_or("its cells are text".into())));
    }
    let as_number = |text: &str| text::number(text, options);
    let wrong = cells.iter().enumerate().find_map(|(at, cell)| {
        let text = (*cell)?.text()?;
        as_number(text).is_none().then_some((at, text))
    });
    if let Some((at, text)) = wrong {
        return Err((at, text.chars().take(40).collect()));
    }
    let days = there().all(|cell| matches!(cell, Cell::Days(_)));
    let first =
        there().find_map(|cell| if let Cell::Days(days) = cell { Some(*days) } else { None });
    let steps = |days: f64| (days * SECONDS_A_DAY * STEPS).round();
    let first = first.filter(|_| days).unwrap_or(0.0);
    let number = |cell: &Option<&Cell>| match cell {
        Some(Cell::Days(day)) if days => steps(day - first) / STEPS,
        Some(Cell::Number(number) | Cell::Days(number)) => *number,
        Some(Cell::Text(text)) => as_number(text).unwrap_or(f64::NAN),
        _ => f64::NAN,
    };
    let since = (steps(first - EPOCH) as i64).saturating_mul(STEP);
    Ok(Ok((cells.iter().map(number).collect(), days.then_some(since))))
}

/// Rows of two cells, the first a text: `Fahrzeug | Wagen 5`.
fn pairs(sheet: &str, rows: &[Row]) -> Vec<(String, String)> {
    let pair = |row: &Row| match row.1.as_slice() {
        [(_, Cell::Text(name)), (_, value)] => {
            Some((format!("{sheet}: {}", name.trim()), value.words()))
        }
        _ => None,
    };
    rows.iter().filter_map(pair).take(MOST_FACTS).collect()
}

/// `A`, `Z`, `AA`: the column as Excel names it.
fn letters(column: u32) -> String {
    let mut rest = column + 1;
    let mut letters = Vec::new();
    while rest > 0 {
        letters.push(char::from(b'A' + ((rest - 1) % 26) as u8));
        rest = (rest - 1) / 26;
    }
    letters.into_iter().rev().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_have_letters() {
        assert_eq!([0, 25, 26, 701, 702].map(letters), ["A", "Z", "AA", "ZZ", "AAA"]);
    }
}
