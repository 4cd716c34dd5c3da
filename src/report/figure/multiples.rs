//! Small diagrams of many quantities: the values of each in the order of the sections, with the
//! limits.

use super::axis::Scale;
use super::canvas::{Canvas, Font, Group};
use super::frame::Frame;
use super::legend::{Entry, Legend};
use super::pair_mark::{pair_group, tooltip};
use super::style::{DASHED, GRID, INK, MUTED, SMALL, TEXT, WIDTH, cut, text_width};
use super::zones::{Marks, Zones};
use crate::report::brief::{Line, Matrix, Numbered};
use crate::report::number;
use crate::result::QuantityResult;

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
        entries.push(Entry::line(INK, 0.9, DASHED, "limit"));
    }
    let legend = Legend::new(entries, WIDTH);
    let heads = if matrix.columns == [""] { 0.0 } else { 21.0 };
    let first = legend.height() + heads + 4.0;
    let mut canvas = Canvas::new(WIDTH, first + lines.len() as f64 * (HEAD + HEIGHT + GAP));
    legend.draw(&mut canvas, (0.0, 0.0));
    let width = WIDTH / matrix.columns.len() as f64;
    canvas.draw(|layer| {
        for (at, column) in matrix.columns.iter().enumerate() {
            let center = (at as f64 + 0.5) * width + 0.5 * AXIS;
            // The signal, and below it its places.
            let (signal, places) = column.split_once(' ').unwrap_or((column, ""));
            layer.text(
                &cut(signal, TEXT, width - 6.0),
                (center, legend.height() + 7.0),
                &Font::middle(TEXT).bold(true),
            );
            layer.text(
                &cut(places, SMALL, width - 6.0),
                (center, legend.height() + 15.0),
                &Font::middle(SMALL),
            );
        }
    });
    for (at, line) in lines.iter().enumerate() {
        let top = first + at as f64 * (HEAD + HEIGHT + GAP);
        canvas.draw(|layer| {
            layer.text(&cut(&words(line), TEXT, WIDTH), (0.0, top + 5.0), &Font::left(TEXT))
        });
        for (column, cell) in line.cells.iter().enumerate() {
            if let Some(cell) = cell {
                let left = column as f64 * width;
                one(&mut canvas, *cell, &marks, (left + AXIS, left + width - 4.0), top + HEAD);
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
    let of_values = quantity
        .statistics
        .iter()
        .filter(|one| one.unit == quantity.unit && one.name != "std" && one.divided_at.is_none());
    let mut all: Vec<f64> = of_values
        .filter_map(|one| one.limit)
        .flat_map(|limit| if two_sided { vec![-limit, limit] } else { vec![limit] })
        .collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

fn one(
    canvas: &mut Canvas,
    (_, quantity): Numbered<'_>,
    marks: &Marks<'_>,
    (left, right): (f64, f64),
    top: f64,
) {
    let limits = limits(quantity);
    let along = quantity.values.iter().map(|pair| pair.difference).chain(limits.iter().copied());
    let mut sections: Vec<&str> = Vec::new();
    for pair in &quantity.values {
        if sections.last() != Some(&pair.section.as_str())
            && !sections.contains(&pair.section.as_str())
        {
            sections.push(&pair.section);
        }
    }
    let frame = Frame {
        x: Scale { low: -0.5, high: sections.len().max(1) as f64 - 0.5, from: left, to: right },
        y: Scale::over(along, top + HEIGHT, top),
    };
    let ticks = frame.y.ticks(TICKS);
    let room = AXIS - 4.0;
    canvas.draw(|layer| {
        for tick in &ticks {
            let y = frame.y.at(tick.value);
            layer.line((left, y), (right, y), GRID, 0.4);
            let size = if text_width(&tick.label, SMALL) > room { 4.6 } else { SMALL };
            layer.text(&tick.label, (left - 2.5, y), &Font::right(size).color(MUTED));
        }
    });
    canvas.group(&Group { class: "limit", dash: DASHED, ..Group::default() }, |layer| {
        for limit in &limits {
            layer.line((left, frame.y.at(*limit)), (right, frame.y.at(*limit)), INK, 0.7);
        }
    });
    let decimals =
        number::decimals(&quantity.unit, quantity.values.iter().map(|pair| pair.difference));
    for pair in quantity.values.iter().filter(|pair| pair.difference.is_finite()) {
        let at = sections.iter().position(|section| *section == pair.section).unwrap_or_default();
        let (mark, color) = marks.mark(pair);
        let title = tooltip(pair, quantity, decimals);
        canvas.group(&pair_group(pair, &title), |layer| {
            layer.mark(mark, (frame.x.at(at as f64), frame.y.at(pair.difference)), 1.2, color)
        });
    }
    if quantity.values.is_empty() {
        canvas.draw(|layer| {
            layer.text(
                "no values",
                (f64::midpoint(left, right), top + 0.5 * HEIGHT),
                &Font::middle(SMALL).color(MUTED),
            )
        });
    }
    frame.spine(canvas);
    // The unit of the values, as a panel has no title of its axis.
    if quantity.unit != "-" {
        canvas.draw(|layer| {
            layer.text(
                &format!("[{}]", number::unit(&quantity.unit)),
                (right, top - 3.0),
                &Font::right(SMALL).color(MUTED),
            )
        });
    }
}
