//! Excel workbooks: each sheet with rows of numbers is a table, with names in one row and units in
//! the next.

use std::io::{Cursor, Read as _};

use calamine::{DataRef, Reader, Xlsx, XlsxError};

use super::guard::damaged;
use super::load::{Budget, most_unpacked, unpacks_to_more};
use super::text::{most_are_units, name_and_unit, stamps_from_first, unbracketed};
use super::{Channel, Format, Input, Place, Read, Table};
use crate::problem::Problem;

/// Columns of a sheet.
const COLUMNS: u32 = 16_384;
const SECONDS_A_DAY: f64 = 86_400.0;
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

pub(super) fn read(input: &Input<'_>) -> Result<Read, Vec<Problem>> {
    let shown = input.shown;
    let bad = |place: &str, why: &dyn std::fmt::Display| damaged(Format::Xlsx, shown, place, why);
    unpacks(input)?;
    let mut book: Xlsx<_> =
        Xlsx::new(Cursor::new(&input.bytes[..])).map_err(|error| bad("the workbook", &error))?;
    let mut budget = Budget::new(input.bytes.len(), shown);
    let mut read = Read::default();
    for name in book.sheet_names() {
        let place = format!("sheet `{name}`");
        let rows = match rows(&mut book, &name, &mut budget, &place) {
            Ok(rows) => rows,
            Err(Failure::NotASheet) => continue,
            Err(Failure::Problem(problem)) => return Err(problem.into()),
            Err(Failure::Damaged(why)) => return Err(bad(&place, &why).into()),
        };
        match table(input, &name, rows, &mut budget)? {
            Ok(table) => read.tables.push(table),
            Err(facts) => {
                read.facts.push((format!("sheet `{name}`"), "no rows of numbers".into()));
                read.facts.extend(facts);
            }
        }
    }
    if read.tables.is_empty() {
        return Err(Problem::error(
            "no-numbers",
            format!("`{shown}` has no sheet with rows of numbers"),
        )
        .into());
    }
    Ok(read)
}

/// Unpacks every part once to count its bytes: what a part declares is not what it holds.
fn unpacks(input: &Input<'_>) -> Result<(), Problem> {
    let shown = input.shown;
    let bad = |place: &str, why: &dyn std::fmt::Display| damaged(Format::Xlsx, shown, place, why);
    let mut archive = zip::ZipArchive::new(Cursor::new(&input.bytes[..]))
        .map_err(|error| bad("the list of its parts", &error))?;
    let mut left = most_unpacked(input.bytes.len()) as u64;
    for index in 0..archive.len() {
        let part =
            archive.by_index(index).map_err(|error| bad(&format!("part {}", index + 1), &error))?;
        let name = part.name().map_or_else(|_| format!("{}", index + 1), |name| name.into_owned());
        let size = std::io::copy(&mut part.take(left + 1), &mut std::io::sink())
            .map_err(|error| bad(&format!("part `{name}`"), &error))?;
        if size > left {
            return Err(unpacks_to_more(shown, &format!("part `{name}`"), input.bytes.len()));
        }
        left -= size;
    }
    Ok(())
}

enum Failure {
    /// A chart or a macro.
    NotASheet,
    Problem(Problem),
    Damaged(String),
}

/// The filled cells of a sheet. They are streamed: a sheet may declare a range of 17 thousand
/// million cells.
fn rows(
    book: &mut Xlsx<Cursor<&[u8]>>,
    name: &str,
    budget: &mut Budget<'_>,
    place: &str,
) -> Result<Vec<Row>, Failure> {
    let mut reader = match book.worksheet_cells_reader(name) {
        Ok(reader) => reader,
        Err(XlsxError::NotAWorksheet(_)) => return Err(Failure::NotASheet),
        Err(error) => return Err(Failure::Damaged(error.to_string())),
    };
    let mut rows: Vec<Row> = Vec::new();
    loop {
        let last = rows.last().map_or(0, |(row, _)| row + 1);
        let Some(cell) = reader
            .next_cell()
            .map_err(|error| Failure::Damaged(format!("after row {last}: {error}")))?
        else {
            break;
        };
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
        if matches!(&content, Cell::Text(text) if text.trim().is_empty()) {
            continue;
        }
        if column >= COLUMNS {
            return Err(Failure::Damaged(format!(
                "row {}: a cell in column {}",
                row + 1,
                column + 1
            )));
        }
        // A cell with its text takes as much as several numbers.
        budget.add(CELL, place).map_err(Failure::Problem)?;
        match rows.last_mut() {
            Some((last, cells)) if *last == row => cells.push((column, content)),
            Some((last, _)) if *last > row => {
                return Err(Failure::Damaged(format!("row {} follows row {}", row + 1, *last + 1)));
            }
            _ => rows.push((row, vec![(column, content)])),
        }
    }
    Ok(rows)
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
    let is_number = |cell: &Cell| !matches!(cell, Cell::Text(_));
    let numeric = |row: &Row| {
        let numbers = row.1.iter().filter(|(_, cell)| is_number(cell)).count();
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
    let row_at = |number: usize| before.iter().find(|row| row.0 as usize + 1 == number);
    let named = |number: usize, what: &str| {
        row_at(number).ok_or_else(|| {
            let says =
                format!("row {number} of sheet `{name}` of `{}`, said to have the {what}, is empty or among the numbers", input.shown);
            Problem::error("header-line", says).help(format!("the numbers begin in row {}", data[0].0 + 1))
        })
    };
    let texts = |row: &Row| -> Vec<(u32, String)> {
        row.1.iter().map(|(column, cell)| (*column, words(cell))).collect()
    };
    let full: Vec<&Row> = before.iter().filter(|row| 2 * row.1.len() >= widest).collect();
    let units = match options.units_line {
        Some(0) => None,
        Some(number) => Some(named(number, "units")?),
        None => full
            .iter()
            .skip(1)
            .rev()
            .find(|row| most_are_units(texts(row).iter().map(|(_, text)| text.as_str())))
            .copied(),
    };
    let names = match options.names_line {
        Some(number) => Some(named(number, "names")?),
        None => full.iter().rev().find(|row| units.is_none_or(|units| row.0 < units.0)).copied(),
    };
    let heading = |row: Option<&Row>, column: u32| {
        row.and_then(|row| row.1.iter().find(|(other, _)| *other == column))
            .map(|(_, cell)| words(cell))
            .filter(|text| !text.is_empty())
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
        ..Table::default()
    };
    table.facts = pairs(name, before);
    let mut cells: Vec<Vec<Option<&Cell>>> = vec![vec![None; data.len()]; columns.len()];
    for (at, (_, row)) in data.iter().enumerate() {
        for (column, cell) in row {
            if let Ok(index) = columns.binary_search(column) {
                cells[index][at] = Some(cell);
            }
        }
    }
    for (column, cells) in columns.into_iter().zip(cells) {
        let (called, unit) = heading(names, column).map_or_else(
            || (format!("column {}", letters(column)), None),
            |text| name_and_unit(&text),
        );
        let unit = heading(units, column).and_then(|text| unbracketed(&text)).or(unit);
        match values(input, &cells) {
            Ok((values, time)) => table.channels.push(Channel {
                name: called,
                unit: if time { Some("s".into()) } else { unit },
                comment: time.then(|| "seconds from the first time".into()),
                values,
                place: Place { column: column as usize + 1, span: None },
            }),
            Err(Mixed::Text) => table.left_out.push((called, "its cells are text".into())),
            Err(Mixed::At(at, text)) => {
                let row = data[at].0 + 1;
                let says = format!(
                    "`{}`, sheet `{name}`, cell {}{row}: `{text}` is not a number as in the rows before",
                    input.shown,
                    letters(column)
                );
                return Err(Problem::error("not-a-number", says)
                    .help("correct the cell, or leave it empty"));
            }
        }
    }
    Ok(Ok(table))
}

enum Mixed {
    Text,
    /// A text among numbers: row and text.
    At(usize, String),
}

/// The values of a column, and whether they are times.
fn values(input: &Input<'_>, cells: &[Option<&Cell>]) -> Result<(Vec<f64>, bool), Mixed> {
    fn text<'a>(cell: &Option<&'a Cell>) -> Option<&'a str> {
        match cell {
            Some(Cell::Text(text)) => Some(text),
            _ => None,
        }
    }
    match cells.iter().flatten().next() {
        None | Some(Cell::Text(_)) => {
            let texts: Vec<&str> = cells.iter().map(|cell| text(cell).unwrap_or("")).collect();
            let all = cells.iter().flatten().all(|cell| matches!(cell, Cell::Text(_)));
            let times = stamps_from_first(&texts, input.options, input.shown).filter(|_| all);
            return times.map(|times| (times, true)).ok_or(Mixed::Text);
        }
        _ => {}
    }
    if let Some((at, wrong)) =
        cells.iter().enumerate().find_map(|(at, cell)| text(cell).map(|text| (at, text)))
    {
        return Err(Mixed::At(at, wrong.chars().take(40).collect()));
    }
    let days = cells.iter().flatten().all(|cell| matches!(cell, Cell::Days(_)));
    let first = cells
        .iter()
        .flatten()
        .find_map(|cell| if let Cell::Days(days) = cell { Some(*days) } else { None })
        .unwrap_or(0.0);
    let number = |cell: &Option<&Cell>| match cell {
        Some(Cell::Days(day)) if days => (day - first) * SECONDS_A_DAY,
        Some(Cell::Number(number) | Cell::Days(number)) => *number,
        _ => f64::NAN,
    };
    Ok((cells.iter().map(number).collect(), days))
}

/// Rows of two cells, the first a text: `Fahrzeug | Wagen 5`.
fn pairs(sheet: &str, rows: &[Row]) -> Vec<(String, String)> {
    let pair = |row: &Row| match row.1.as_slice() {
        [(_, Cell::Text(name)), (_, value)] => {
            Some((format!("{sheet}: {}", name.trim()), words(value)))
        }
        _ => None,
    };
    rows.iter().filter_map(pair).take(MOST_FACTS).collect()
}

fn words(cell: &Cell) -> String {
    match cell {
        Cell::Number(number) | Cell::Days(number) => number.to_string(),
        Cell::Text(text) => text.trim().to_string(),
    }
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
