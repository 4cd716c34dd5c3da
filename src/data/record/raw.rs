//! Every column of a record as it is in the file, for a copy in another format.

use std::path::Path;

use super::{Format, columnar, fault, listed_headings, text::no_rows};
use crate::data::{
    cells::{self, RawCell},
    faults::Faults,
    text::{LARGEST_RECORD, LONGEST_LINE, decode, long_line, read_bytes},
    write::{Digits, FileColumn, Values},
};
use crate::problem::Problem;

/// Reads all columns: numbers in the unit of the file, or texts if a cell is not a number.
///
/// # Errors
/// As [`super::read_record`], of the file, its header and its rows.
pub fn read_raw(path: &Path, shown: &str) -> Result<Vec<FileColumn>, Vec<Problem>> {
    if Format::of(path) == Format::Parquet {
        return columnar::raw(path, shown);
    }
    let bytes = read_bytes(path, shown, LARGEST_RECORD)?;
    let text = decode(&bytes, shown)?;
    let mut lines = text.split('\n').enumerate();
    if let Some((at, line)) = lines.find(|(_, line)| line.len() > LONGEST_LINE) {
        return Err(long_line(line.as_bytes(), at + 1, shown).into());
    }
    let headings = listed_headings(text, shown)?;
    let rows = text.split_once('\n').map_or("", |(_, rows)| rows).trim_end();
    if rows.is_empty() {
        return Err(no_rows(shown).into());
    }
    let mut columns: Vec<Numbers> = vec![Numbers::default(); headings.len()];
    each_row(rows, shown, headings.len(), |_, cells| {
        columns.iter_mut().zip(cells).for_each(|(column, cell)| column.add(&cell.text));
    })?;
    let mut texts: Vec<Vec<String>> = vec![Vec::new(); headings.len()];
    if columns.iter().any(|column| column.text || column.irregular) {
        // Only now it is known which columns are texts, and the most digits of the others.
        each_row(rows, shown, headings.len(), |row, cells| {
            for ((column, texts), cell) in columns.iter_mut().zip(&mut texts).zip(cells) {
                match column.text {
                    true => texts.push(cell.text),
                    false => column.compare(row, &cell.text),
                }
            }
        })?;
    }
    let made = headings.iter().zip(columns).zip(texts).map(|((heading, column), texts)| {
        let (name, digits) = (&heading.name, column.form());
        let heading = match &heading.unit {
            Some(unit) => format!("{name} [{}]", unit.text),
            None => name.clone(),
        };
        let values =
            if column.text { Values::Texts(texts) } else { Values::Numbers(column.values) };
        FileColumn { heading, values, digits }
    });
    Ok(made.collect())
}

fn each_row(
    rows: &str,
    shown: &str,
    width: usize,
    mut each: impl FnMut(usize, Vec<RawCell>),
) -> Result<(), Vec<Problem>> {
    let mut faults = Faults::new(shown);
    for (row, line) in rows.split('\n').enumerate() {
        let text = line.trim_end_matches('\r');
        match cells::split(text) {
            Ok(cells) if cells.len() == width && !text.trim().is_empty() => each(row, cells),
            _ => {
                let line = fault::Line { text, number: row + 2, last: false, shown };
                fault::slow_row(&line, width, &mut [], &mut faults);
            }
        }
    }
    faults.finish(())
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
    /// Most significant digits of a cell.
    significant: usize,
    /// A cell differs from this form.
    not_significant: bool,
    not_shortest: bool,
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
        let decimals = *self.decimals.get_or_insert_with(|| {
            cell.split_once('.').map_or(0, |(_, decimals)| decimals.len().min(Digits::MOST))
        });
        self.irregular = self.irregular || Digits::Decimals(decimals).write(value) != cell;
        self.significant = self.significant.max(Digits::significant(cell));
    }

    /// Whether a cell of an irregular column has one of the other forms.
    fn compare(&mut self, row: usize, cell: &str) {
        let Some(value) = self.values.get(row).copied().filter(|_| self.irregular) else { return };
        self.not_significant =
            self.not_significant || Digits::Significant(self.significant).write(value) != cell;
        self.not_shortest = self.not_shortest || Digits::Shortest.write(value) != cell;
    }

    /// The form of all cells.
    fn form(&self) -> Option<Digits> {
        let decimals = self.decimals.filter(|_| !self.irregular).map(Digits::Decimals);
        let significant = (!self.not_significant).then_some(Digits::Significant(self.significant));
        let shortest = (!self.not_shortest).then_some(Digits::Shortest);
        decimals.or(significant).or(shortest).filter(|_| !self.text)
    }
}
