//! Tables: columns with their titles, units and alignment, and rows of cells.

use crate::result::Reason;
use serde::{Serialize, Serializer};

use super::{
    Medium,
    cell::{Cell, Content},
    finding::{Finding, Tone},
    text::{Run, Text},
};
use crate::report::number;

/// A table.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    pub caption: Text,
    pub columns: Vec<Column>,
    pub rows: Vec<Row>,
    /// How it is dressed on a screen: a class of the style sheet.
    pub class: &'static str,
    /// Size of its letters on paper \[pt\]; the number of columns decides where it is not stated.
    size: Option<f64>,
    /// With more rows than this, it stands in two halves, side by side.
    abreast: Option<usize>,
    /// With no more rows than this, it stays on one page.
    kept: usize,
}

/// A column of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    pub title: String,
    /// As printed; empty where the title says it or there is none.
    pub unit: String,
    /// Title above this one and its neighbours of the same.
    above: Option<String>,
    /// Aligned to the right.
    numeric: bool,
    width: Width,
    /// A word from this length on may be broken anywhere.
    breaks: usize,
    /// Its cells name the row.
    names_row: Option<bool>,
    /// Left out if all its cells are empty.
    sparse: bool,
    /// On paper, only the first of rows about the same thing has this cell.
    once: bool,
    /// Printed in one medium only.
    only: Option<Medium>,
}

/// Width of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Width {
    /// Not wider than its texts.
    Least,
    /// A share of what is left, by the length of its texts.
    ByText,
    /// A share of what is left.
    Share(f64),
}

/// Letters of a word that is not broken in a column of texts, and in one of names.
const UNBROKEN: usize = 30;
const UNBROKEN_NAME: usize = 10;

/// A row of a table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// One for each column.
    pub cells: Vec<Cell>,
    /// What the row came to.
    pub tone: Option<Tone>,
    pub zone: Option<String>,
}

impl Row {
    pub fn toned(self, tone: Tone) -> Self {
        Self { tone: Some(tone), ..self }
    }

    /// With what the row came to as its last cell, and the reason.
    pub fn ending(mut self, finding: Finding, reason: Option<&Reason>) -> Self {
        let tone = finding.tone;
        let reason = reason.map(|reason| format!(": {}", number::raised(reason.text())));
        let text = Text::from(Run::Finding(finding)).and(reason.unwrap_or_default());
        self.cells.push(Cell::text(text));
        self.toned(tone)
    }

    pub fn in_zone(self, zone: Option<&str>) -> Self {
        Self { zone: zone.map(str::to_owned), ..self }
    }
}

impl From<Vec<Cell>> for Row {
    fn from(cells: Vec<Cell>) -> Self {
        Self { cells, ..Self::default() }
    }
}

/// Rows and letters of a table that stays on one page.
const KEPT: usize = 18;
const LETTERS_KEPT: usize = 2400;
/// Columns from which on a table is one of many columns.
const MANY: usize = 9;

impl Table {
    /// Without columns and rows.
    pub fn new(caption: impl Into<Text>) -> Self {
        Self {
            caption: caption.into(),
            columns: Vec::new(),
            rows: Vec::new(),
            class: "sortable",
            size: None,
            abreast: None,
            kept: KEPT,
        }
    }

    /// With one more column, to the right of the others.
    fn column(mut self, title: impl Into<String>, width: Width, breaks: usize) -> Self {
        self.columns.push(Column {
            title: title.into(),
            unit: String::new(),
            above: None,
            numeric: false,
            width,
            breaks,
            names_row: None,
            sparse: false,
            once: false,
            only: None,
        });
        self
    }

    /// With a column of texts, which takes its part of the width.
    pub fn text(self, title: impl Into<String>) -> Self {
        self.column(title, Width::ByText, UNBROKEN)
    }

    /// With a column of texts not wider than these.
    pub fn short(self, title: impl Into<String>) -> Self {
        self.column(title, Width::Least, UNBROKEN)
    }

    /// With a column of names of users, which may be long words.
    pub fn name(self, title: impl Into<String>) -> Self {
        self.column(title, Width::Least, UNBROKEN_NAME)
    }

    /// With a column of numbers, aligned at the decimal point.
    pub fn number(self, title: impl Into<String>) -> Self {
        self.short(title).last(|column| column.numeric = true)
    }

    /// With columns of numbers.
    pub fn numbers<T: Into<String>>(self, titles: impl IntoIterator<Item = T>) -> Self {
        self.each(titles, Self::number)
    }

    /// With columns for each of several things.
    pub fn each<T>(
        self,
        all: impl IntoIterator<Item = T>,
        with: impl FnMut(Self, T) -> Self,
    ) -> Self {
        all.into_iter().fold(self, with)
    }

    /// With columns under a condition.
    pub fn when(self, holds: bool, with: impl FnOnce(Self) -> Self) -> Self {
        if holds { with(self) } else { self }
    }

    fn last(mut self, change: impl FnOnce(&mut Column)) -> Self {
        self.columns.last_mut().map(change);
        self
    }

    /// The last column with a share of the width that is left.
    pub fn wide(self, share: f64) -> Self {
        self.last(|column| column.width = Width::Share(share))
    }

    /// The last column with a unit as printed after its title; none for a dimensionless number.
    pub fn unit(self, unit: &str) -> Self {
        let unit = number::unit(unit);
        self.last(|column| column.unit = if unit == number::NONE { String::new() } else { unit })
    }

    /// The last column with neighbours of the same under one title.
    pub fn under(self, title: impl Into<String>) -> Self {
        self.last(|column| column.above = Some(title.into()))
    }

    /// Words of the last column from this length on may be broken.
    pub fn breaks(self, from: usize) -> Self {
        self.last(|column| column.breaks = from)
    }

    /// Whether the cells of the last column name the row; those of the first column do if nothing
    /// is stated.
    pub fn names_row(self, names: bool) -> Self {
        self.last(|column| column.names_row = Some(names))
    }

    /// The last column is left out if all its cells are empty.
    pub fn sparse(self) -> Self {
        self.last(|column| column.sparse = true)
    }

    /// On paper, the last column is filled only in the first of rows that begin with the same cell.
    pub fn once(self) -> Self {
        self.last(|column| column.once = true)
    }

    /// The last column is printed in one medium only.
    pub fn only(self, medium: Medium) -> Self {
        self.last(|column| column.only = Some(medium))
    }

    /// With its rows, each with a cell for each column.
    pub fn rows<R: Into<Row>>(self, rows: impl IntoIterator<Item = R>) -> Self {
        Self { rows: rows.into_iter().map(Into::into).collect(), ..self }
    }

    /// With another class of the style sheet.
    pub fn class(self, class: &'static str) -> Self {
        Self { class, ..self }
    }

    /// With letters of this size on paper \[pt\].
    pub fn size(self, size: f64) -> Self {
        Self { size: Some(size), ..self }
    }

    /// In two halves side by side if it has more rows than this.
    pub fn abreast(self, rows: usize) -> Self {
        Self { abreast: Some(rows), ..self }
    }

    /// On one page if it has no more rows than this.
    pub fn kept(self, rows: usize) -> Self {
        Self { kept: rows, ..self }
    }

    /// What one medium prints of it, without columns that are empty.
    pub fn on(&self, medium: Medium) -> Self {
        let filled = |at: usize| {
            self.rows.iter().any(|row| row.cells.get(at).is_some_and(|cell| !cell.is_empty()))
        };
        let shown = |(at, one): (usize, &Column)| {
            one.only.is_none_or(|only| only == medium) && (!one.sparse || filled(at))
        };
        let kept: Vec<bool> = self.columns.iter().enumerate().map(shown).collect();
        let again =
            |at: usize| at > 0 && self.rows[at].cells.first() == self.rows[at - 1].cells.first();
        let cell = |row: usize, at: usize, cell: &Cell| {
            let once = medium == Medium::Paper && self.columns[at].once && again(row);
            if once { Cell::BLANK } else { cell.clone() }
        };
        let row = |(at, row): (usize, &Row)| {
            // A cell over several columns stands for them; no column of such a table is left out.
            let cells = row.cells.iter().enumerate().filter(|(column, _)| kept[*column]);
            let cells = cells.map(|(column, one)| cell(at, column, one)).collect();
            Row { cells, ..row.clone() }
        };
        let columns = self.columns.iter().zip(&kept).filter(|(_, kept)| **kept);
        Self {
            columns: columns.map(|(column, _)| column.clone()).collect(),
            rows: self.rows.iter().enumerate().map(row).collect(),
            ..self.clone()
        }
    }

    /// The texts of a column as printed.
    pub fn printed(&self, title: &str) -> Vec<String> {
        let at = self.columns.iter().position(|column| column.title == title);
        let cells = at.map(|at| self.rows.iter().filter_map(move |row| row.cells.get(at)));
        cells.into_iter().flatten().map(|cell| cell.printed().letters()).collect()
    }
}

/// A table as the templates place it.
#[derive(Serialize)]
struct Placed<'a> {
    caption: &'a Text,
    class: &'static str,
    size: f64,
    /// Blank space at both sides of a cell \[pt\].
    inset: f64,
    keep: bool,
    /// Shares of the width, 0 for one as wide as its texts.
    widths: Vec<f64>,
    numeric: Vec<bool>,
    breaks: Vec<usize>,
    names_row: Vec<bool>,
    /// The first column under a title that stands above several.
    starts: Vec<bool>,
    head: Vec<Vec<Head<'a>>>,
    /// The rows, in halves where these stand side by side.
    parts: Vec<Vec<PlacedRow<'a>>>,
}

#[derive(Serialize)]
struct Head<'a> {
    /// In lines, so that the head of a number is not much wider than the number.
    title: Vec<&'a str>,
    unit: &'a str,
    numeric: bool,
    across: usize,
    down: usize,
}

#[derive(Serialize)]
struct PlacedRow<'a> {
    tone: Option<Tone>,
    zone: Option<&'a str>,
    /// One for each column; none where another cell takes its place.
    cells: Vec<Option<PlacedCell>>,
}

/// A plain text, or one with something about it.
#[derive(Serialize)]
#[serde(untagged)]
enum PlacedCell {
    Plain(Text),
    Dressed {
        text: Text,
        pad: String,
        tone: Option<Tone>,
        strong: bool,
        across: usize,
        down: usize,
    },
}

impl Serialize for Table {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let printed: Vec<Vec<Text>> =
            self.rows.iter().map(|row| row.cells.iter().map(Cell::printed).collect()).collect();
        let letters: usize = printed.iter().flatten().map(|text| text.letters().len()).sum();
        let halved = self.abreast.is_some_and(|most| self.rows.len() > most);
        let half = if halved { self.rows.len().div_ceil(2) } else { self.rows.len() };
        let mut rows = self.placed_rows(printed);
        let many = self.columns.len() >= MANY;
        let names = |(at, column): (usize, &Column)| column.names_row.unwrap_or(at == 0);
        let other = rows.split_off(half);
        let parts = if other.is_empty() { vec![rows] } else { vec![rows, other] };
        Placed {
            caption: &self.caption,
            class: self.class,
            size: self.size.unwrap_or(match self.columns.len() {
                0..=5 => 8.5,
                6..MANY => 8.0,
                MANY..=10 => 7.3,
                _ => 6.8,
            }),
            inset: if many { 2.4 } else { 3.5 },
            keep: self.rows.len() <= self.kept && letters <= LETTERS_KEPT,
            widths: self.widths(),
            numeric: self.columns.iter().map(|column| column.numeric).collect(),
            breaks: self.columns.iter().map(|column| column.breaks).collect(),
            names_row: self.columns.iter().enumerate().map(names).collect(),
            starts: self.starts(),
            head: self.head(),
            parts,
        }
        .serialize(to)
    }
}

impl Table {
    /// A column of sentences gets more of the width than one of names.
    fn widths(&self) -> Vec<f64> {
        let longest = |at: usize| {
            let cells = self.rows.iter().filter_map(|row| row.cells.get(at));
            cells.map(|cell| cell.printed().letters().chars().count()).max().unwrap_or(1)
        };
        let width = |(at, column): (usize, &Column)| match column.width {
            Width::Share(share) => share,
            Width::ByText if self.columns.len() < MANY => {
                (longest(at) as f64 / 20.0).sqrt().clamp(1.0, 3.0)
            }
            Width::ByText | Width::Least => 0.0,
        };
        self.columns.iter().enumerate().map(width).collect()
    }

    fn starts(&self) -> Vec<bool> {
        let above = |at: usize| self.columns[at].above.as_ref();
        let starts = |at: usize| above(at).is_some() && (at == 0 || above(at) != above(at - 1));
        (0..self.columns.len()).map(starts).collect()
    }

    /// One row of titles, or two where some stand above others.
    fn head(&self) -> Vec<Vec<Head<'_>>> {
        let two = self.columns.iter().any(|column| column.above.is_some());
        let mut above: Vec<Head<'_>> = Vec::new();
        let mut below: Vec<Head<'_>> = Vec::new();
        let mut last: Option<&str> = None;
        for column in &self.columns {
            let head = |down| Head {
                title: self.lines(column),
                unit: &column.unit,
                numeric: column.numeric,
                across: 1,
                down,
            };
            match (column.above.as_deref(), above.last_mut()) {
                (None, _) => above.push(head(if two { 2 } else { 1 })),
                (Some(title), Some(before)) if last == Some(title) => {
                    before.across += 1;
                    below.push(head(1));
                }
                (Some(title), _) => {
                    let title = vec![title];
                    above.push(Head { title, unit: "", across: 1, down: 1, numeric: true });
                    below.push(head(1));
                }
            }
            last = column.above.as_deref();
        }
        if two { vec![above, below] } else { vec![above] }
    }

    fn lines<'a>(&self, column: &'a Column) -> Vec<&'a str> {
        match column.title.rsplit_once(' ') {
            Some((first, last)) if column.numeric && self.columns.len() >= MANY => {
                vec![first, last]
            }
            _ => vec![&column.title],
        }
    }

    fn placed_rows(&self, printed: Vec<Vec<Text>>) -> Vec<PlacedRow<'_>> {
        // Decimals of each column, for the alignment at the point.
        let numbers = |at: usize| {
            self.rows.iter().zip(&printed).filter_map(move |(row, texts)| {
                let number = row.cells.get(at)?.is_number();
                number.then(|| decimals(&texts[at]))
            })
        };
        let most: Vec<usize> = (0..self.columns.len())
            .map(|at| if self.columns[at].numeric { numbers(at).max().unwrap_or(0) } else { 0 })
            .collect();
        let mut taken = vec![0_usize; self.columns.len()];
        let mut rows = Vec::new();
        for (row, texts) in self.rows.iter().zip(printed) {
            let mut given = row.cells.iter().zip(texts);
            let mut cells = Vec::new();
            while cells.len() < self.columns.len() {
                let at = cells.len();
                if taken[at] > 0 {
                    taken[at] -= 1;
                    cells.push(None);
                    continue;
                }
                let Some((cell, text)) = given.next() else { break };
                taken[at] = cell.down - 1;
                let number = cell.is_number();
                let pad = if number { padding(decimals(&text), most[at]) } else { String::new() };
                cells.push(Some(cell.placed(text, pad)));
                cells.extend((1..cell.across).map(|_| None));
            }
            rows.push(PlacedRow { tone: row.tone, zone: row.zone.as_deref(), cells });
        }
        rows
    }
}

impl Cell {
    fn is_number(&self) -> bool {
        matches!(self.content, Content::Number(..) | Content::Given(_))
    }

    fn placed(&self, text: Text, pad: String) -> PlacedCell {
        let plain = pad.is_empty() && self.tone.is_none() && !self.strong;
        if plain && self.across == 1 && self.down == 1 {
            return PlacedCell::Plain(text);
        }
        let (across, down) = (self.across, self.down);
        PlacedCell::Dressed { text, pad, tone: self.tone, strong: self.strong, across, down }
    }
}

/// Digits after the point of a printed number.
fn decimals(number: &Text) -> usize {
    number.letters().split_once('.').map_or(0, |(_, after)| after.chars().count())
}

/// What a number lacks in width of the longest fraction of its column; nothing where the column is
/// not aligned.
fn padding(own: usize, most: usize) -> String {
    let point = if own == 0 && most > 0 { "." } else { "" };
    format!("{point}{}", "0".repeat(most.saturating_sub(own)))
}
