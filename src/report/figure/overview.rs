//! Overview of all quantities: every statistic divided by its limit, with its sign.

use indexmap::IndexSet;

use super::{kit::*, symbol::symbol};
use crate::report::estimates;
use crate::result::{QuantityResult, StatisticName, StatisticResult};

/// Maximum number of statistics of a quantity on separate lines; more share one line.
const LINES: usize = 3;
/// Maximum of the axis; values beyond are shown as an arrow with a number.
const FARTHEST: f64 = 2.0;
/// Space for the results at the right, in points.
const FINDINGS: f64 = 66.0;
/// Normal and reduced height of a line, in points.
const LINE: (f64, f64) = (7.5, 5.0);
/// Normal and reduced distance between quantities, in points.
const GAP: (f64, f64) = (6.0, 3.0);
/// Number of lines from which the reduced heights are used.
const CLOSE: usize = 50;

/// Normalised statistics of the quantities, one row each, with the limit at 1 (and -1 for signed
/// statistics).
///
/// A statistic beyond its limit is labelled with its number and with the word at the end of the
/// row, so that colour is not needed.
pub fn overview(quantities: &[QuantityResult]) -> String {
    // What is reported without a limit has nothing to draw.
    let some = quantities.iter().any(|one| !one.decides_nothing());
    let quantities: Vec<&QuantityResult> =
        quantities.iter().filter(|one| !some || !one.decides_nothing()).collect();
    let series = Series::of(&quantities);
    let lines: Vec<usize> = quantities.iter().map(|quantity| line_count(quantity)).collect();
    let total: usize = lines.iter().sum();
    let (line, gap) = if total > CLOSE { (LINE.1, GAP.1) } else { (LINE.0, GAP.0) };
    let labels =
        quantities.iter().map(|one| text_width(&one.symbol, TEXT)).fold(20.0, f64::max).min(120.0);
    let left = labels + 10.0;
    let right = WIDTH - FINDINGS;
    let mut entries = series.legend();
    if entries.is_empty() {
        entries.push(Entry::ground(SHADE, "within the limit"));
    }
    let legend = Legend::new(entries, right - left);
    let top = legend.height() + 14.0;
    let height = total as f64 * line + quantities.len() as f64 * gap + gap;
    let mut canvas = Canvas::new(WIDTH, top + height + 26.0);
    let frame = Frame::rows(range(&quantities), (left, right), (top, top + height));
    legend.draw(&mut canvas, (left, 0.0));
    ground(&mut canvas, &frame);
    let mut y = top + gap;
    for (quantity, lines) in quantities.iter().zip(&lines) {
        let tall = *lines as f64 * line;
        row(&mut canvas, &frame, quantity, &series, (y, line, *lines), labels);
        y += tall + gap;
    }
    frame.spine(&mut canvas);
    canvas.finish()
}

/// Statistics with a limit; of a limit by group, the decisive one.
fn shown(quantity: &QuantityResult) -> impl Iterator<Item = &StatisticResult> {
    estimates::representatives(quantity)
        .into_iter()
        .filter(|statistic| statistic.limit.is_some() || statistic.normalised.is_some())
}

fn line_count(quantity: &QuantityResult) -> usize {
    match shown(quantity).count() {
        0 => 1,
        n if n > LINES => 1,
        n => n,
    }
}

/// The normalised value with the sign of the statistic.
fn signed(statistic: &StatisticResult) -> Option<f64> {
    let size = statistic.normalised.filter(|value| value.is_finite())?.abs();
    Some(if statistic.value.is_some_and(|value| value < 0.0) { -size } else { size })
}

/// The different statistics of all quantities, each with its mark.
struct Series(IndexSet<(String, String)>);

impl Series {
    fn of(quantities: &[&QuantityResult]) -> Self {
        let of = |quantity: &&QuantityResult| {
            shown(quantity).map(|statistic| Self::key(quantity, statistic)).collect::<Vec<_>>()
        };
        Self(quantities.iter().flat_map(of).collect())
    }

    /// An estimate of all values, or of groups, is one series, wherever its decisive group is.
    fn key(quantity: &QuantityResult, statistic: &StatisticResult) -> (String, String) {
        let grouped =
            quantity.from.is_some() || !statistic.scope.keys.is_empty() || statistic.scope.is_all();
        (statistic.title.clone(), if grouped { String::new() } else { statistic.scope.to_string() })
    }

    fn nth(&self, quantity: &QuantityResult, statistic: &StatisticResult) -> usize {
        self.0.get_index_of(&Self::key(quantity, statistic)).unwrap_or(0)
    }

    fn legend(&self) -> Vec<Entry> {
        let text = |(title, scope): &(String, String)| {
            number::formula(&if scope.is_empty() {
                title.clone()
            } else {
                format!("{title}, {scope}")
            })
        };
        self.0.iter().enumerate().map(|(n, key)| Entry::mark(look(n), text(key))).collect()
    }
}

fn range(quantities: &[&QuantityResult]) -> Range {
    let values: Vec<f64> =
        quantities.iter().flat_map(|quantity| shown(quantity)).filter_map(signed).collect();
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let high =
        if largest <= 1.15 { 1.25 } else { ((largest + 0.15) * 4.0).ceil() / 4.0 }.min(FARTHEST);
    let has_sign = values.iter().any(|value| *value < 0.0)
        || quantities
            .iter()
            .filter(|quantity| quantity.from.is_none())
            .flat_map(|quantity| shown(quantity))
            .any(|one| one.name == StatisticName::Mean);
    (if has_sign { -high } else { 0.0 }, high)
}

fn ground(canvas: &mut Canvas, frame: &Frame) {
    frame.beyond_right(canvas);
    if frame.x.contains(-1.0) {
        canvas.rect((frame.left(), frame.top()), frame.upright(-1.0).1, BEYOND);
    }
    frame.x_axis(canvas, 9, "statistic divided by its limit");
    for limit in [-1.0, 1.0].into_iter().filter(|limit| frame.x.contains(*limit)) {
        let (top, bottom) = frame.upright(limit);
        canvas.line(top, bottom, INK, 1.0);
        canvas.text("limit", (top.0, top.1 - 6.0), &Font::middle(TEXT));
    }
    let (top, bottom) = frame.upright(0.0);
    canvas.line(top, bottom, MUTED, 0.6);
}

fn row(
    canvas: &mut Canvas,
    frame: &Frame,
    quantity: &QuantityResult,
    series: &Series,
    (top, line, lines): (f64, f64, usize),
    labels: f64,
) {
    let middle = top + lines as f64 * line / 2.0;
    let fails = quantity.holds == Some(false);
    let group = Group { title: Some(&quantity.title), ..Group::class("row") };
    canvas.group(&group, |canvas| {
        let font = Font::right(TEXT).bold(fails);
        symbol(canvas, &quantity.symbol, (frame.left() - 6.0, middle), &font, labels);
    });
    if !quantity.decides_nothing() {
        finding(canvas, quantity.holds, (frame.right() + 8.0, middle));
    }
    let statistics: Vec<&StatisticResult> = shown(quantity).collect();
    let farthest = statistics.iter().filter_map(|one| signed(one)).map(f64::abs).reduce(f64::max);
    let Some(farthest) = farthest else {
        let says = match (quantity.holds, statistics.is_empty()) {
            (None, _) => "not assessable",
            (_, true) if quantity.values.is_empty() => "no values",
            (_, true) => "no limit",
            // A value that is not above zero has no ratio to a limit that it should reach.
            (_, false) => "no ratio to the limit",
        };
        return nothing(canvas, frame, middle, says);
    };
    let shared = statistics.len() > LINES;
    for (at, statistic) in statistics.iter().enumerate() {
        let y = top + line * (0.5 + if lines == 1 { 0.0 } else { at as f64 });
        match signed(statistic) {
            Some(value) => {
                let shape = Shape {
                    look: look(series.nth(quantity, statistic)),
                    stem: !shared,
                    // On a shared line the numbers would overlap: only the largest is labelled.
                    named: !shared || value.abs() == farthest,
                    size: TEXT.min(line + 0.5),
                };
                value_mark(canvas, frame, (&quantity.symbol, statistic), (value, y), &shape);
            }
            None if !shared => {
                nothing(canvas, frame, y, &format!("{}: not assessable", statistic.title))
            }
            None => {}
        }
    }
}

/// The word of a result with its sign, drawn without a font.
fn finding(canvas: &mut Canvas, holds: Option<bool>, (x, y): Point) {
    let word = match holds {
        Some(true) => {
            canvas.path(&[(x, y + 0.3), (x + 2.2, y + 2.6), (x + 6.2, y - 2.8)], INK, 1.1);
            "met"
        }
        Some(false) => {
            canvas.line((x + 0.5, y - 2.6), (x + 5.7, y + 2.6), INK, 1.4);
            canvas.line((x + 0.5, y + 2.6), (x + 5.7, y - 2.6), INK, 1.4);
            "not met"
        }
        None => {
            canvas.line((x, y), (x + 6.0, y), MUTED, 1.1);
            "not assessed"
        }
    };
    canvas.text(word, (x + 9.5, y), &Font::left(TEXT).bold(holds == Some(false)));
}

fn nothing(canvas: &mut Canvas, frame: &Frame, y: f64, says: &str) {
    canvas.group(&Group::class("none"), |canvas| {
        canvas.text(says, (frame.x.at(0.0) + 4.0, y), &Font::left(SMALL + 0.5).color(MUTED));
    });
}

/// How a statistic is drawn.
struct Shape {
    look: (Mark, Color),
    /// With a line from zero.
    stem: bool,
    /// With its number if the criterion is not met.
    named: bool,
    /// Size of the number, in points.
    size: f64,
}

fn value_mark(
    canvas: &mut Canvas,
    frame: &Frame,
    (symbol, statistic): (&str, &StatisticResult),
    (value, y): (f64, f64),
    &Shape { look, stem, named, size }: &Shape,
) {
    let says = match value.abs() {
        size if size < 10.0 => number::beside(value, 1.0, 2),
        size if size > 1000.0 => number::ratio(size),
        _ => number::significant(value, 3),
    };
    let title = format!("{symbol}, {} ({}): {says} of the limit", statistic.title, statistic.scope);
    let clipped = !frame.x.contains(value);
    let (x, outward) = (frame.x.within(value), value.signum());
    canvas.group(&Group::mark(&title).edge(0.5), |canvas| {
        if stem {
            canvas.line((frame.x.at(0.0), y), (x, y), look.1, 2.2);
        }
        if clipped {
            // An arrow.
            let back = x - outward * 5.5;
            canvas.fill(&[(x, y), (back, y - 3.4), (back, y + 3.4)], look.1);
        } else {
            canvas.mark(look, (x, y), 2.7);
        }
    });
    if !named || !(statistic.holds == Some(false) || clipped) {
        return;
    }
    // Outside the mark if there is space, else on the stem's side with a background.
    let wide = text_width(&says, size) + 6.0;
    let room = if outward > 0.0 { frame.right() - x } else { x - frame.left() };
    let outside = !clipped && room > wide;
    let (direction, start) = if outside { (outward, 4.5) } else { (-outward, 7.5) };
    let at = x + direction * start;
    if !outside {
        let half = size / 2.0 - 0.4;
        let end = at + direction * (wide - 4.0);
        canvas.rect((at - direction * 1.5, y - half), (end, y + half), GRID);
    }
    let font = if direction > 0.0 { Font::left(size) } else { Font::right(size) };
    canvas.text(&says, (at, y), &font.bold(true));
}
