//! Many quantities in few pages: a table with one line for each comparison and one column for each
//! signal.

use indexmap::IndexMap;

use crate::result::QuantityResult;

/// More quantities than this have no chapter each: the report would have more pages than anybody
/// reads.
pub const MOST_CHAPTERS: usize = 30;
/// Of these, quantities with a chapter: those farthest beyond their limits.
const IN_FULL: usize = 12;
/// Number of signals side by side that fit a page.
const ABREAST: usize = 6;

/// A quantity with its index.
pub type Numbered<'a> = (usize, &'a QuantityResult);

/// Quantities by comparison and signal.
#[derive(Clone, Debug)]
pub struct Matrix<'a> {
    /// Signals in words; a single empty one where a line is one quantity.
    pub columns: Vec<&'a str>,
    pub lines: Vec<Line<'a>>,
}

/// Quantities that differ only in their signals.
#[derive(Clone, Debug)]
pub struct Line<'a> {
    /// One for each column.
    pub cells: Vec<Option<Numbered<'a>>>,
}

impl<'a> Line<'a> {
    /// The first of them, with whose words the line is described; a line has at least one.
    pub fn first(&self) -> Option<&'a QuantityResult> {
        self.cells.iter().flatten().map(|(_, quantity)| *quantity).next()
    }
}

pub fn is_brief(quantities: &[QuantityResult]) -> bool {
    quantities.len() > MOST_CHAPTERS
}

/// Indices of the quantities that have a chapter, in order.
pub fn in_full(quantities: &[QuantityResult]) -> Vec<usize> {
    if !is_brief(quantities) {
        return (0..quantities.len()).collect();
    }
    let ratio = |at: &usize| {
        quantities[*at].statistics.iter().filter_map(|one| one.normalised).fold(0.0, f64::max)
    };
    let mut chosen: Vec<usize> =
        (0..quantities.len()).filter(|&at| quantities[at].holds != Some(true)).collect();
    chosen.sort_by(|a, b| ratio(b).total_cmp(&ratio(a)));
    chosen.truncate(IN_FULL);
    chosen.sort_unstable();
    chosen
}

/// All quantities of a brief report.
pub fn matrices<'a>(quantities: &'a [QuantityResult]) -> Vec<Matrix<'a>> {
    let mut lines: IndexMap<(&str, &str, &str, usize), IndexMap<&'a str, Numbered<'a>>> =
        IndexMap::new();
    for (at, quantity) in quantities.iter().enumerate() {
        let mut nth = 0;
        // Two quantities of the same words differ in their sections, for instance: the second has a
        // line of its own.
        loop {
            let line = lines
                .entry((&quantity.comparison, &quantity.processing, &quantity.filter, nth))
                .or_default();
            if !line.contains_key(quantity.of.as_str()) {
                line.insert(&quantity.of, (at, quantity));
                break;
            }
            nth += 1;
        }
    }
    let mut columns: Vec<&'a str> = Vec::new();
    for signal in lines.values().flat_map(IndexMap::keys) {
        if !columns.contains(signal) {
            columns.push(signal);
        }
    }
    // A table that is mostly empty says less than a list.
    if lines.len() * columns.len() > 3 * quantities.len() {
        let line = |(at, quantity)| Line { cells: vec![Some((at, quantity))] };
        return vec![Matrix {
            columns: vec![""],
            lines: quantities.iter().enumerate().map(line).collect(),
        }];
    }
    let matrix = |columns: &[&'a str]| {
        let cells = |line: &IndexMap<&'a str, Numbered<'a>>| {
            columns.iter().map(|signal| line.get(signal).copied()).collect()
        };
        let lines = lines.values().map(|line| Line { cells: cells(line) });
        Matrix {
            columns: columns.to_vec(),
            lines: lines.filter(|line| line.first().is_some()).collect(),
        }
    };
    columns.chunks(ABREAST).map(matrix).collect()
}
