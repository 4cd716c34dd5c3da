//! Many quantities: one line for each comparison, one column for each signal, and small diagrams.

use super::View;
use crate::report::{
    brief::{self, Line, Matrix},
    document::*,
    figure, number,
};
use crate::result::QuantityResult;
use crate::words;

/// In place of a chapter for each of many quantities: what is printed of which, tables, diagrams.
pub fn blocks(view: &View<'_>) -> Vec<Block> {
    let quantities = &view.found.quantities;
    if !brief::is_brief(quantities) {
        return Vec::new();
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
    let sentence = format!(
        "{} quantities are more than are read one by one. The table has the mean of the values of each over the sections, and the smallest and the largest value; the diagrams have every value.{chapters} All values are in tables/values.csv.",
        quantities.len()
    );
    let tables = matrices.iter().map(|matrix| table(matrix, view.work).into());
    let figures = matrices.iter().enumerate().flat_map(|(at, matrix)| figures(at, matrix));
    std::iter::once(Block::text(sentence)).chain(tables).chain(figures).collect()
}

fn figures(at: usize, matrix: &Matrix<'_>) -> Vec<Block> {
    let all = matrix.lines.chunks(figure::LINES).enumerate();
    all.map(|(page, lines)| {
        let caption = format!("Values in the order of the sections: {}", contents(lines));
        let alt = format!(
            "Small diagrams of {} quantities; their means and ranges are in the table.",
            lines.iter().flat_map(|line| line.cells.iter().flatten()).count()
        );
        Figure::new(figure::multiples_name(at, page), caption, alt, 225).into()
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

fn table(matrix: &Matrix<'_>, work: Option<&str>) -> Table {
    let single = matrix.columns == [""];
    let row = |line: &Line<'_>| {
        let first = line.first()?;
        let title = if single { first.title.clone() } else { title(first) };
        let source = first.source.as_deref().map(|source| super::with_work(source, work));
        let quiet = |says: String| {
            let title = [Text::from(&title), Run::Quiet(says).into()];
            Text::lines(title.into_iter().filter(|text| !text.letters().is_empty()))
        };
        let paper = source.as_ref().map(|source| format!("; {source}")).unwrap_or_default();
        let mut cells = cells![
            quiet(first.filter.clone() + &paper),
            quiet(source.unwrap_or_default()),
            first.filter
        ];
        let quantity = |cell: &Option<(usize, &QuantityResult)>| {
            Cell::or_missing(cell.map(|(_, quantity)| self::cell(quantity)))
        };
        cells.extend(line.cells.iter().map(quantity));
        Some(cells)
    };
    let head = if single { "Quantity" } else { "Comparison" };
    let signals = matrix.columns.iter().map(|one| if one.is_empty() { "Values" } else { one });
    let several = if single { "" } else { "; one column for each signal" };
    let caption =
        format!("Mean of the values over the sections, smallest to largest value{several}");
    Table::new(caption)
        .text(head)
        .wide(2.0)
        .only(Medium::Paper)
        .text(head)
        .only(Medium::Screen)
        .names_row(true)
        .text("Filter")
        .only(Medium::Screen)
        .each(signals, |table, signal| table.number(signal).wide(1.0))
        .rows(matrix.lines.iter().filter_map(row))
        .class("brief")
        .size(7.0)
}

/// The mean of the values, what it came to, and their range.
fn cell(quantity: &QuantityResult) -> Text {
    let values = || quantity.values.iter().map(|pair| pair.difference);
    let decimals = number::decimals_of(values(), 3);
    let (low, high, sum) = values()
        .fold((f64::INFINITY, f64::NEG_INFINITY, 0.0), |(low, high, sum), x| {
            (low.min(x), high.max(x), sum + x)
        });
    let count = quantity.values.len();
    let (mean, range) = if count == 0 {
        (number::NONE.to_owned(), words::or_nothing(quantity.reason.as_ref()))
    } else {
        let mean = number::fixed(sum / count as f64, decimals);
        (
            number::with_unit(&mean, &quantity.unit),
            format!("{} to {}", number::fixed(low, decimals), number::fixed(high, decimals)),
        )
    };
    let mut text = Text::from(Run::Strong(mean));
    if !quantity.decides_nothing() {
        text = text.and(" ").then(Run::Mark(Finding::of_quantity(quantity)));
    }
    text.then(Run::Break(())).then(Run::Quiet(range))
}
