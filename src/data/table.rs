//! A small CSV table such as `sections.csv`: named rows, and cells with their places.

use std::{collections::HashMap, sync::Arc};

use super::{
    cells::{self, Heading},
    faults::Faults,
};
use crate::data::prelude::*;

/// A table with the same number of cells in every row, and a name per row if it was read with a
/// key.
#[derive(Clone, Debug)]
pub struct Table {
    pub source: Arc<Source>,
    /// SHA-256 of the file.
    pub sha256: String,
    pub columns: Vec<Heading>,
    /// One cell per column, in the order of the file.
    pub rows: Vec<Vec<Cell>>,
    /// The column with the names of the rows, if they have names.
    key: Option<usize>,
    /// The first row of each name.
    named: HashMap<String, usize>,
}

/// Names of devices of Windows, which no file can have there, whatever its ending
/// (<https://learn.microsoft.com/windows/win32/fileio/naming-a-file>).
const DEVICES: [&str; 6] = ["con", "prn", "aux", "nul", "com", "lpt"];

/// Warns of names of rows that cannot be those of files on every system.
pub fn not_portable(table: &Table, problems: &mut Problems) {
    let mut known: HashMap<String, &Cell> = HashMap::new();
    for name in table.names() {
        let lower = name.value.to_lowercase();
        let stem = lower.split('.').next().unwrap_or_default();
        let device = |device: &str| match stem.strip_prefix(device) {
            Some(rest) if ["com", "lpt"].contains(&device) => {
                matches!(rest.as_bytes(), [b'1'..=b'9'])
            }
            rest => rest == Some(""),
        };
        let says = if DEVICES.into_iter().any(device) {
            Some(format!("`{}` is the name of a device on Windows", name.value))
        } else if name.value.ends_with('.') {
            Some(format!("`{}` ends in a point, which Windows drops from names", name.value))
        } else {
            None
        };
        if let Some(says) = says {
            let problem = warning("name-not-portable", says, &name.span);
            problems.push(problem.help("its records cannot be copied there: choose another name"));
        }
        match known.get(&lower) {
            Some(before) if before.value != name.value => {
                let says = format!("`{}` and `{}` differ by case alone", before.value, name.value);
                let problem = warning("name-not-portable", says, &name.span);
                let help = "on Windows and macOS they are the same file: choose another name";
                problems.push(problem.also(&before.span, "the other one").help(help));
            }
            _ => drop(known.insert(lower, name)),
        }
    }
}

/// The text of a cell without quotes and surrounding blanks, and its place.
pub type Cell = Spanned<String>;

impl Table {
    /// A table that is not in a file, with the names of its rows in the first column.
    ///
    /// # Errors
    /// The first of the problems of a table that is read.
    pub fn of_text(name: &str, text: &str) -> Result<Self, Problem> {
        let mut problems = Problems::default();
        let sha256 = super::hash::sha256(text.as_bytes());
        let table = Self::parse(Source::new(name, text), sha256, Some(""), &mut problems);
        table.ok_or_else(|| {
            problems
                .0
                .into_iter()
                .next()
                .unwrap_or_else(|| problem!("internal", "the table `{name}` cannot be made"))
        })
    }

    /// Reads the text of a table. With a key, the column of that name, or else the first column,
    /// has the names of the rows.
    ///
    /// Problems: `semicolon-separated`, `tab-separated`, `stray-quote`, `duplicate-column`; per row
    /// `blank-line`, `header-repeated`, `ragged-row`, `decimal-comma`, `name-missing`,
    /// `duplicate-name`; `no-rows`.
    pub fn parse(
        source: Arc<Source>,
        sha256: String,
        key: Option<&str>,
        problems: &mut Problems,
    ) -> Option<Self> {
        let name = source.name.clone();
        let mut faults = Faults::new(&name);
        let mut lines = lines(&source);
        let mut found = Vec::new();
        let header = lines.next();
        let columns = header.as_ref().and_then(|line| cells::headings(line, &mut found));
        found.into_iter().for_each(|problem| faults.push(|| problem));
        let (Some(header), Some(columns)) = (header, columns) else {
            faults.add_to(problems);
            return None;
        };
        let key = key.map(|key| columns.iter().position(|column| column.name == key).unwrap_or(0));
        let rows: Vec<Vec<Cell>> =
            lines.filter_map(|line| row(&line, (&header, &columns), &mut faults)).collect();
        if rows.is_empty() && faults.is_empty() {
            faults
                .push(|| error("no-rows", "the table has a header and no rows", &columns[0].span));
        }
        let table = Self { source, sha256, columns, rows, key, named: HashMap::new() };
        table.with_names(faults, problems)
    }

    /// The same table with the names of its rows in a column, which must be there.
    ///
    /// Problems: `unknown-column`; `name-missing`, `duplicate-name`.
    pub fn named_by(mut self, column: &str, problems: &mut Problems) -> Option<Self> {
        self.key = Some(problems.value(self.need_column(column))?);
        let file = self.source.name.clone();
        self.with_names(Faults::new(&file), problems)
    }

    /// Checks the names of the rows, and keeps the first row of each: each section asks for its row
    /// more than once.
    fn with_names(mut self, mut faults: Faults<'_>, problems: &mut Problems) -> Option<Self> {
        let mut named: HashMap<String, usize> = HashMap::with_capacity(self.rows.len());
        let column = self.key.and_then(|key| self.columns.get(key));
        let names: Vec<&Cell> = self.names().collect();
        for (row, name) in names.iter().enumerate() {
            if name.value.is_empty() {
                let key = column.map_or("", |column| &column.name);
                let says = || format!("the row has no `{key}`");
                faults.push(|| error("name-missing", says(), &name.span));
            } else if let Some(before) = named.get(&name.value) {
                let says = || format!("two rows are called `{}`", name.value);
                faults.push(|| {
                    error("duplicate-name", says(), &name.span)
                        .also(&names[*before].span, "the first of them")
                });
                continue;
            }
            named.entry(name.value.clone()).or_insert(row);
        }
        self.named = named;
        let good = faults.is_empty();
        faults.add_to(problems);
        good.then_some(self)
    }

    /// The names of the rows in order; none if it was read without a key.
    pub fn names(&self) -> impl Iterator<Item = &Cell> {
        self.rows.iter().filter_map(|row| row.get(self.key?))
    }

    pub fn row_named(&self, name: &str) -> Option<usize> {
        self.named.get(name).copied()
    }

    /// The index of a column by its name without unit.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.name == name)
    }

    /// The index of a required column.
    ///
    /// # Errors
    /// `unknown-column`, at the header, with the nearest names.
    pub fn need_column(&self, name: &str) -> Result<usize, Problem> {
        self.column(name).ok_or_else(|| {
            let header = self.columns[0].span.to(&self.columns[self.columns.len() - 1].span);
            problem!("unknown-column", &header, "the table has no column `{name}`")
                .suggest(name, self.columns.iter().map(|column| &column.name))
        })
    }

    pub fn cell(&self, row: usize, column: usize) -> Option<&Cell> {
        self.rows.get(row)?.get(column)
    }

    /// As [`Table::numbers`], of the column with a name, which must be there.
    ///
    /// # Errors
    /// As [`Table::need_column`] and [`Table::numbers`].
    pub fn numbers_named(
        &self,
        column: &str,
        dimension: Option<Dimension>,
    ) -> Result<Vec<Option<f64>>, Vec<Problem>> {
        self.numbers(self.need_column(column)?, dimension)
    }

    /// A column as numbers in SI; `None` where a cell is empty.
    ///
    /// # Errors
    /// Of the heading (see [`Heading::unit`]) or of every cell that is not a finite number:
    /// `not-a-number`, `not-finite`, `decimal-comma`.
    pub fn numbers(
        &self,
        column: usize,
        dimension: Option<Dimension>,
    ) -> Result<Vec<Option<f64>>, Vec<Problem>> {
        let Some(heading) = self.columns.get(column) else { return Ok(Vec::new()) };
        let unit = heading.unit(dimension)?;
        let mut faults = Faults::new(&self.source.name);
        let mut values = Vec::with_capacity(self.rows.len());
        for cell in self.rows.iter().filter_map(|row| row.get(column)) {
            match cells::number(&cell.value) {
                _ if cell.value.is_empty() => values.push(None),
                Ok(number) => values.push(Some(unit.to_si(number))),
                Err((code, says)) => {
                    faults.push(|| problem!(code, &cell.span, "`{}`: {says}", heading.name))
                }
            }
        }
        faults.finish(values)
    }
}

/// The lines of a text without line breaks and without blank lines at its end.
fn lines(source: &Arc<Source>) -> impl Iterator<Item = Span> {
    let text = source.text.trim_end_matches(['\n', '\r', ' ', '\t']);
    // The trimmed part may contain blanks of the last line, which belong to no cell.
    let mut from = 0;
    text.split('\n').map(move |line| {
        let start = from;
        from += line.len() + 1;
        source.span(start..start + line.trim_end_matches('\r').len())
    })
}

fn row(
    line: &Span,
    (header, columns): (&Span, &[Heading]),
    faults: &mut Faults<'_>,
) -> Option<Vec<Cell>> {
    if line.text().trim().is_empty() {
        faults.push(|| error("blank-line", "blank line between the rows", line));
        return None;
    }
    // Two tables that were put together.
    if columns.len() > 1 && line.text().trim_end() == header.text().trim_end() {
        faults.push(|| {
            let problem =
                error("header-repeated", "the header stands between the rows again", line);
            problem.also(header, "the header").help("remove this line")
        });
        return None;
    }
    match cells::split(line.text()) {
        Err(place) => faults.push(|| cells::stray_quote(&line.part(place))),
        Ok(cells) if cells.len() == columns.len() => {
            return Some(
                cells.into_iter().map(|cell| Cell::new(cell.text, line.part(cell.place))).collect(),
            );
        }
        Ok(cells) => faults.push(|| cells::ragged(line, &cells, columns.len())),
    }
    None
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn parse(text: &str) -> (Option<Table>, Problems) {
        let mut problems = Problems::default();
        let table =
            Table::parse(Source::new("t", text), String::new(), Some("section"), &mut problems);
        (table, problems)
    }

    const SAMPLE: &str = "section,zone [-],start [m],radius [m],\"note\"\r\nS01,1,105.00,,\"a, b\"\nS02,4,1e2,-250, c \n\n";

    #[test]
    fn cells_keep_their_place_and_units_are_applied() {
        let (table, problems) = parse(SAMPLE);
        let table = table.unwrap_or_else(|| panic!("{}", problems.render(false)));
        assert_eq!(
            table.names().map(|cell| cell.value.as_str()).collect::<Vec<_>>(),
            ["S01", "S02"]
        );
        let cell = table.cell(0, 4).expect("there");
        assert_eq!((cell.value.as_str(), cell.span.to_string()), ("a, b", "t:2:16".to_string()));
        assert_eq!(table.cell(1, 4).map(|cell| cell.span.to_string()), Some("t:3:17".into()));
        assert_eq!(table.numbers(3, Some(Dimension::LENGTH)), Ok(vec![None, Some(-250.0)]));
        assert_eq!(
            table.numbers(2, Some(Dimension::TIME)).map_err(|problems| problems[0].code),
            Err("unit-mismatch")
        );
        assert_eq!(
            table.numbers(4, None).map_err(|problems| problems[0].code),
            Err("unit-missing")
        );
        assert_eq!(
            table.need_column("strat").map_err(|problem| problem.help),
            Err(Some("did you mean `start`?".into()))
        );
        assert_eq!(table.row_named("S02"), Some(1));
    }

    #[test]
    fn carriage_returns_alone_are_told() {
        let (table, problems) = parse("section,speed [km/h]\rS01,100\rS02,100\r");
        let told: Vec<_> = problems
            .0
            .iter()
            .map(|problem| (problem.code, problem.at.as_ref().map(|at| at.text().len())))
            .collect();
        assert_eq!(
            (table.is_none(), told),
            (true, vec![("line-ends", Some("section,speed [km/h]".len()))])
        );
    }

    #[test]
    fn a_header_among_the_rows() {
        let (table, problems) = parse("section,zone [-]\r\nS01,1\r\nsection,zone [-]\r\nS02,2\r\n");
        let places: Vec<_> = problems
            .0
            .iter()
            .map(|problem| (problem.code, problem.at.as_ref().map(ToString::to_string)))
            .collect();
        assert_eq!(
            (table.is_none(), places),
            (true, vec![("header-repeated", Some("t:3:1".to_string()))])
        );
        // A section may be called as the column is.
        assert!(
            parse("section,zone [-]\nsection,1\n").0.is_some()
                && parse("section\nsection\n").0.is_some()
        );
    }

    #[test]
    fn every_prefix_is_survived() {
        (0..=SAMPLE.len()).for_each(|at| drop(parse(&SAMPLE[..at])));
    }

    proptest! {
        #[test]
        fn flipped_bytes_are_survived(flips in prop::collection::vec((0..SAMPLE.len(), any::<u8>()), 1..5)) {
            let mut bytes = SAMPLE.as_bytes().to_vec();
            for (at, byte) in flips {
                bytes[at] = byte;
            }
            let (table, problems) = parse(&String::from_utf8_lossy(&bytes));
            prop_assert_eq!(table.is_none(), problems.any_error());
            problems.render(false);
        }
    }
}
