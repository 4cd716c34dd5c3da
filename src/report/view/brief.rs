//! Many quantities: one line for each comparison, one column for each signal, and small diagrams.

use serde::Serialize;

use super::{FigureView, Finding, with_work};
use crate::report::brief::{self, Line, Matrix};
use crate::report::{figure, number};
use crate::result::QuantityResult;

/// In place of a chapter for each quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BriefView {
    /// What is printed of which quantities.
    pub sentence: String,
    pub tables: Vec<BriefTable>,
    pub figures: Vec<FigureView>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BriefTable {
    /// Signals; a single empty one where a row is one quantity.
    pub columns: Vec<String>,
    pub rows: Vec<BriefRow>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BriefRow {
    /// Comparison, or title of the one quantity.
    pub title: String,
    pub filter: String,
    pub source: Option<String>,
    /// One for each column.
    pub cells: Vec<Option<BriefCell>>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BriefCell {
    /// Mean of the values, with the unit.
    pub mean: String,
    /// `0.12 to 0.48`
    pub range: String,
    pub holds: Finding,
}

pub(super) fn view(quantities: &[QuantityResult], work: Option<&str>) -> Option<BriefView> {
    if !brief::is_brief(quantities) {
        return None;
    }
    let matrices = brief::matrices(quantities);
    let full = brief::in_full(quantities).len();
    let open = quantities.iter().filter(|quantity| quantity.holds != Some(true)).count();
    let chapters = match open {
        0 => String::new(),
        1 => " The one that does not meet its limits has a chapter.".to_owned(),
        open if open == full => {
            format!(" The {open} that do not meet their limits have a chapter each.")
        }
        open => format!(
            " Of the {open} that do not meet their limits, the {full} with the largest ratios have a chapter each."
        ),
    };
    let figures =
        matrices.iter().enumerate().flat_map(|(at, matrix)| figures(at, matrix)).collect();
    Some(BriefView {
        sentence: format!(
            "{} quantities are more than are read one by one. The table has the mean of the values of each over the sections, and the smallest and the largest value; the diagrams have every value.{chapters} All values are in tables/values.csv.",
            quantities.len()
        ),
        tables: matrices.iter().map(|matrix| table(matrix, work)).collect(),
        figures,
    })
}

fn figures(at: usize, matrix: &Matrix<'_>) -> Vec<FigureView> {
    let all = matrix.lines.chunks(figure::LINES).enumerate();
    all.map(|(page, lines)| FigureView {
        name: figure::multiples_name(at, page),
        caption: format!("Values in the order of the sections: {}", contents(lines)),
        alt: format!(
            "Small diagrams of {} quantities; their means and ranges are in the table.",
            lines.iter().flat_map(|line| line.cells.iter().flatten()).count()
        ),
    })
    .collect()
}

/// The first and the last line of a page.
fn contents(lines: &[Line<'_>]) -> String {
    let name = |line: Option<&Line<'_>>| line.and_then(Line::first).map_or_else(String::new, title);
    match lines {
        [one] => name(Some(one)),
        _ => format!("{} to {}", name(lines.first()), name(lines.last())),
    }
}

fn title(quantity: &QuantityResult) -> String {
    let comparison = number::formula(&quantity.comparison);
    if quantity.has_sides { format!("{}, {comparison}", quantity.processing) } else { comparison }
}

fn table(matrix: &Matrix<'_>, work: Option<&str>) -> BriefTable {
    let row = |line: &Line<'_>| {
        let first = line.first();
        let single = matrix.columns == [""];
        BriefRow {
            title: first.map_or_else(String::new, |first| {
                if single { first.title.clone() } else { title(first) }
            }),
            filter: first.map_or_else(String::new, |first| first.filter.clone()),
            source: first
                .and_then(|first| first.source.as_deref())
                .map(|source| with_work(source, work)),
            cells: line
                .cells
                .iter()
                .map(|cell| cell.map(|(_, quantity)| self::cell(quantity)))
                .collect(),
        }
    };
    BriefTable {
        columns: matrix.columns.iter().map(ToString::to_string).collect(),
        rows: matrix.lines.iter().map(row).collect(),
    }
}

fn cell(quantity: &QuantityResult) -> BriefCell {
    let values = || quantity.values.iter().map(|pair| pair.difference);
    let decimals = number::decimals_of(values(), 3);
    let (low, high, sum) = values()
        .fold((f64::INFINITY, f64::NEG_INFINITY, 0.0), |(low, high, sum), x| {
            (low.min(x), high.max(x), sum + x)
        });
    let count = quantity.values.len();
    let (mean, range) = if count == 0 {
        (number::NONE.to_owned(), quantity.reason.clone().unwrap_or_default())
    } else {
        let mean = number::fixed(sum / count as f64, decimals);
        (
            number::with_unit(&mean, &quantity.unit),
            format!("{} to {}", number::fixed(low, decimals), number::fixed(high, decimals)),
        )
    };
    BriefCell { mean, range, holds: Finding::of_quantity(quantity) }
}
