//! Every column of a record as it is in the file, for a copy in another format.

use std::path::Path;

use super::{Format, columnar, fault, header};
use crate::data::cells::{self, RawCell, StrayQuote};
use crate::data::faults::Faults;
use crate::data::text::{decode, read_large};
use crate::data::write::{FileColumn, Values};
use crate::problem::Problem;

/// Reads all columns: numbers in the unit of the file, or texts if a cell is not a number.
///
/// # Errors
/// As [`super::read_record`], of the file, its header and its rows.
pub fn read_raw(path: &Path, shown: &str) -> Result<Vec<FileColumn>, Vec<Problem>> {
    if Format::of(path) == Format::Parquet {
        return columnar::raw(path, shown);
    }
    let one = |problem: Problem| vec![problem];
    let mut bytes = Vec::new();
    read_large(path, shown, &mut bytes).map_err(one)?;
    let text = decode(&bytes, shown).map_err(one)?;
    let (headings, body) = header(text, shown)?;
    let rows = text[body..].trim_end();
    if rows.is_empty() {
        return Err(one(Problem::error("no-rows", format!("`{shown}` has a header and no samples"))));
    }
    let mut faults = Faults::new(shown);
    let mut columns: Vec<Numbers> = vec![Numbers::default(); headings.len()];
    each_row(rows, shown, headings.len(), &mut faults, |cells| {
        columns.iter_mut().zip(cells).for_each(|(column, cell)| column.add(&cell.text));
    });
    faults.finish(())?;
    let mut texts: Vec<Vec<String>> = vec![Vec::new(); headings.len()];
    if columns.iter().any(|column| column.text) {
        let mut none = Faults::new(shown);
        each_row(rows, shown, headings.len(), &mut none, |cells| {
            let of_text = columns.iter().zip(texts.iter_mut()).zip(cells).filter(|((column, _), _)| column.text);
            of_text.for_each(|((_, texts), cell)| texts.push(cell.text));
        });
    }
    let made = headings.iter().zip(columns).zip(texts).map(|((heading, column), texts)| {
        let heading = heading.unit.as_ref().map_or_else(|| heading.name.clone(), |unit| format!("{} [{}]", heading.name, unit.text));
        let decimals = column.decimals.filter(|_| !column.text && !column.irregular);
        let values = if column.text { Values::Texts(texts) } else { Values::Numbers(column.values) };
        FileColumn { heading, values, decimals }
    });
    Ok(made.collect())
}

fn each_row(rows: &str, shown: &str, width: usize, faults: &mut Faults<'_>, mut each: impl FnMut(Vec<RawCell>)) {
    for (row, line) in rows.split('\n').enumerate() {
        let line = fault::Line { text: line.trim_end_matches('\r'), number: row + 2, last: false, shown };
        match cells::split(line.text) {
            _ if line.text.trim().is_empty() => fault::slow_row(&line, width, &mut [], faults),
            Ok(cells) if cells.len() == width => each(cells),
            Ok(_) | Err(StrayQuote(_)) => fault::slow_row(&line, width, &mut [], faults),
        }
    }
}

/// The numbers of a column, as long as each cell is one.
#[derive(Clone, Default)]
struct Numbers {
    values: Vec<f64>,
    text: bool,
    /// Number of decimals of the first cell.
    decimals: Option<usize>,
    /// A cell has another number of decimals, or another form, such as `1e3` or `+1`.
    irregular: bool,
}

impl Numbers {
    fn add(&mut self, cell: &str) {
        if self.text {
            return;
        }
        let Ok(value) = cells::number(cell) else {
            self.text = true;
            self.values = Vec::new();
            return;
        };
        self.values.push(value);
        let decimals = *self.decimals.get_or_insert_with(|| cell.split_once('.').map_or(0, |(_, decimals)| decimals.len()));
        self.irregular = self.irregular || format!("{value:.decimals$}") != cell;
    }
}
