//! Small diagrams of many quantities: the values of each in the order of the sections, with the
//! limits.

use indexmap::IndexSet;

use super::{
    kit::*,
    pair_mark::Pairs,
    zones::{Marks, Zones},
};
use crate::report::brief::{Line, Matrix, Numbered};
use crate::result::{QuantityResult, StatisticName};

/// Lines of diagrams that fit a page.
pub const LINES: usize = 10;
/// Height of a plotting area, of the words above a line, and between lines, in points.
const HEIGHT: f64 = 40.0;
const HEAD: f64 = 11.0;
const GAP: f64 = 7.0;
/// Space of the numbers of an axis, in points.
const AXIS: f64 = 25.0;
const TICKS: usize = 3;

/// Some lines of a matrix.
pub fn multiples(matrix: &Matrix<'_>, lines: &[Line<'_>], zones: &Zones) -> String {
    let quantities = || lines.iter().flat_map(|line| &line.cells).flatten();
    let values = || quantities().flat_map(|(_, quantity)| &quantity.values);
    let marks = Marks::of(values(), zones);
    let mut entries = marks.legend(values());
    if quantities().any(|(_, quantity)| !limits(quantity).is_empty()) {
        entries.push(Entry::line(LIMIT, "limit"));
    }
    let legend = Legend::new(entries, WIDTH);
    let heads = if matrix.columns == [""] { 0.0 } else { 21.0 };
    let first = legend.height() + heads + 4.0;
    let mut canvas = Canvas::new(WIDTH, first + lines.len() as f64 * (HEAD + HEIGHT + GAP));
    legend.draw(&mut canvas, (0.0, 0.0));
    let width = WIDTH / matrix.columns.len() as f64;
    for (at, column) in matrix.columns.iter().enumerate() {
        let center = (at as f64 + 0.5) * width + 0.5 * AXIS;
        // The signal, and below it its places.
        let (signal, places) = column.split_once(' ').unwrap_or((column, ""));
        for (text, down, font) in
            [(signal, 7.0, Font::middle(TEXT).bold(true)), (places, 15.0, Font::middle(SMALL))]
        {
            let shown = cut(text, font.size, width - 6.0);
            canvas.text(&shown, (center, legend.height() + down), &font);
        }
    }
    for (at, line) in lines.iter().enumerate() {
        let top = first + at as f64 * (HEAD + HEIGHT + GAP);
        canvas.text(&cut(&words(line), TEXT, WIDTH), (0.0, top + 5.0), &Font::left(TEXT));
        for (column, cell) in line.cells.iter().enumerate() {
            if let Some(cell) = cell {
                let left = column as f64 * width;
                panel(&mut canvas, *cell, &marks, (left + AXIS, left + width - 4.0), top + HEAD);
            }
        }
    }
    canvas.finish()
}

/// `correlation, low-pass 20 Hz`; the title where a line is one quantity.
fn words(line: &Line<'_>) -> String {
    let Some(first) = line.first() else { return String::new() };
    if line.cells.len() == 1 {
        return first.title.clone();
    }
    let comparison = number::formula(&first.comparison);
    if first.has_sides {
        format!("{}, {comparison}, {}", first.processing, first.filter)
    } else {
        format!("{comparison}, {}", first.filter)
    }
}

/// The limits that are values of the quantity.
fn limits(quantity: &QuantityResult) -> Vec<f64> {
    let two_sided = quantity.values.iter().any(|pair| pair.difference < 0.0);
    let of_values = quantity.statistics.iter().filter(|one| {
        one.unit == quantity.unit
            && one.name != StatisticName::StandardDeviation
            && one.divided_at.is_none()
    });
    let mut all: Vec<f64> = of_values
        .filter_map(|one| one.limit)
        .flat_map(|limit| if two_sided { vec![-limit, limit] } else { vec![limit] })
        .collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

fn panel(
    canvas: &mut Canvas,
    (_, quantity): Numbered<'_>,
    marks: &Marks<'_>,
    (left, right): (f64, f64),
    top: f64,
) {
    let limits = limits(quantity);
    let along = quantity.values.iter().map(|pair| pair.difference).chain(limits.iter().copied());
    let sections: IndexSet<&str> =
        quantity.values.iter().map(|pair| pair.section.as_str()).collect();
    let x = (-0.5, sections.len().max(1) as f64 - 0.5);
    let frame = Frame::new(x, axis::over(along), (left, right), (top, top + HEIGHT));
    for tick in frame.y.ticks(TICKS) {
        let (from, to) = frame.across(tick.value);
        canvas.line(from, to, GRID, 0.4);
        let size = if text_width(&tick.label, SMALL) > AXIS - 4.0 { 4.6 } else { SMALL };
        canvas.text(&tick.label, (left - 2.5, from.1), &Font::right(size).color(MUTED));
    }
    let lines = limits.iter().map(|limit| frame.across(*limit));
    canvas.lines("limit", Pen { width: 0.7, ..LIMIT }, lines);
    let pairs = Pairs::new(quantity);
    for pair in quantity.values.iter().filter(|pair| pair.difference.is_finite()) {
        let section = sections.get_index_of(pair.section.as_str()).unwrap_or_default();
        let at = frame.at(section as f64, pair.difference);
        pairs.draw(canvas, pair, marks.mark(pair), at, 1.2);
    }
    if quantity.values.is_empty() {
        frame.empty(canvas, "no values", &Font::middle(SMALL).color(MUTED));
    }
    frame.spine(canvas);
    // The unit of the values, as a panel has no title of its axis.
    if quantity.unit != "-" {
        let unit = format!("[{}]", number::unit(&quantity.unit));
        canvas.text(&unit, (right, top - 3.0), &Font::right(SMALL).color(MUTED));
    }
}
