//! Regressions of the values of groups: one small diagram for each group, in a row on the same
//! scale.

use super::{kit::*, zones::Zones};
use crate::report::estimates::OfLimit;
use crate::result::{QuantityResult, RegressionFigure, StatisticResult};

/// Most diagrams side by side, and most in a figure: those of the largest ratio, so that they stay
/// readable on one page.
const ABREAST: usize = 4;
pub const MOST: usize = 16;
/// Height of a diagram, in points: one alone, and of several.
const TALL: f64 = 158.0;
const LOW: f64 = 88.0;
/// Space of a line of the name above a diagram, of two, and of the axis below, in points.
const HEAD: f64 = 12.0;
const HEADS: f64 = 20.0;
const FOOT: f64 = 13.0;
const GUTTER: f64 = 9.0;
/// Share of an axis in the width of a diagram, about, in points.
const AXIS: f64 = 10.0;
const TICKS: usize = 5;

const FIT: Pen = Pen::solid(BLUE, 1.2);
const BOUND: Pen = Pen { color: VERMILION, width: 1.1, dash: DASH_DOT };
const TARGET: Pen = Pen { color: MUTED, width: 0.8, dash: DOTTED };
const ESTIMATE: (Mark, Color) = (Mark::Diamond, INK);

/// The groups of a limit that have a regression to draw, in order; of many those with the largest
/// ratio.
pub fn drawn<'a>(limit: &OfLimit<'a>) -> Vec<(&'a StatisticResult, &'a RegressionFigure)> {
    let mut all: Vec<_> =
        limit.results.iter().filter_map(|one| Some((*one, one.regression.as_deref()?))).collect();
    if all.len() > MOST {
        let mut ratios: Vec<f64> =
            all.iter().map(|(one, _)| one.normalised.unwrap_or(0.0)).collect();
        ratios.sort_by(|a, b| b.total_cmp(a));
        let least = ratios[MOST - 1];
        all.retain(|(one, _)| one.normalised.unwrap_or(0.0) >= least);
        all.truncate(MOST);
    }
    all
}

/// The regressions of the groups of one limit.
pub fn regression(
    quantity: &QuantityResult,
    groups: &[(&StatisticResult, &RegressionFigure)],
    zones: &Zones,
) -> String {
    let points = || groups.iter().flat_map(|(_, one)| &one.points);
    let curves = || groups.iter().flat_map(|(_, one)| &one.curve);
    let bound = groups.iter().find_map(|(_, one)| one.bound.as_deref());
    let mut entries = zones.legend(points().map(|point| point.zone.as_deref()));
    entries.push(Entry::line(FIT, "regression"));
    entries.extend(bound.map(|bound| Entry::line(BOUND, bound)));
    entries.push(Entry::line(TARGET, "target"));
    entries.push(Entry::mark(ESTIMATE, "estimate"));
    if groups.iter().any(|(one, _)| one.limit.is_some()) {
        entries.push(Entry::line(LIMIT, "limit"));
    }
    let legend = Legend::new(entries, WIDTH - 40.0);
    let x = axis::over(curves().map(|at| at.x));
    let tall = if groups.len() == 1 { TALL } else { LOW };
    let abreast = groups.len().clamp(1, ABREAST);
    let rows = groups.len().div_ceil(abreast);
    let top = legend.height() + 6.0;
    let narrow = (WIDTH - 4.0) / abreast as f64 - GUTTER;
    let scopes: Vec<String> =
        groups.iter().map(|(statistic, _)| statistic.scope.to_string()).collect();
    let head = if scopes.iter().all(|scope| text_width(scope, TICK) <= narrow - AXIS) {
        HEAD
    } else {
        HEADS
    };
    let row = head + tall + FOOT;
    let heights: Vec<Range> = groups
        .chunks(abreast)
        .map(|row| axis::over(row.iter().flat_map(|(one, figure)| heights(one, figure))))
        .collect();
    let left = heights.iter().map(|y| axis::room(*y, TICKS)).fold(0.0, f64::max);
    let wide = (WIDTH - 4.0 - left - GUTTER * (abreast as f64 - 1.0)) / abreast as f64;
    let bottom = top + rows as f64 * row;
    let mut canvas = Canvas::new(WIDTH, bottom + 13.0);
    legend.draw(&mut canvas, (left, 0.0));
    let names = names(&scopes, wide);
    for (at, group) in groups.iter().enumerate() {
        let (column, line) = (at % abreast, at / abreast);
        let from = left + column as f64 * (wide + GUTTER);
        let upper = top + line as f64 * row + head;
        let frame = Frame::new(x, heights[line], (from, from + wide), (upper, upper + tall));
        // The x axis has no title, since all diagrams have the same; y has numbers at the first
        // of a row.
        if column == 0 {
            frame.y_axis(&mut canvas, TICKS, &axis::title(&quantity.symbol, &quantity.unit));
        } else {
            frame.y_grid(&mut canvas, TICKS);
        }
        frame.x_numbers(&mut canvas, &frame.x.ticks(TICKS), SMALL);
        for (up, line) in names[at].iter().rev().filter(|line| !line.is_empty()).enumerate() {
            let y = frame.top() - 6.0 - 8.0 * up as f64;
            canvas.text(line, (frame.center().0, y), &Font::middle(TICK));
        }
        panel(&mut canvas, &frame, quantity, *group, zones);
    }
    let title = groups
        .first()
        .map_or_else(String::new, |(_, one)| axis::title(&one.regressor, &one.regressor_unit));
    let middle = (f64::midpoint(left, WIDTH - 4.0), bottom + 6.0);
    canvas.text(&title, middle, &Font::middle(TEXT));
    canvas.finish()
}

/// The name of each diagram in two lines of a width; the first holds as many parts as fit.
fn names(scopes: &[String], wide: f64) -> Vec<[String; 2]> {
    let split = |scope: &str| -> [String; 2] {
        if text_width(scope, TICK) <= wide {
            return [String::new(), scope.to_owned()];
        }
        let places: Vec<usize> = scope.match_indices(", ").map(|(at, _)| at).collect();
        let fits = places
            .iter()
            .rev()
            .find(|at| text_width(&scope[..=**at], TICK) <= wide)
            .or(places.first());
        fits.map_or_else(
            || [String::new(), scope.to_owned()],
            |at| [scope[..=*at].to_owned(), scope[at + 2..].to_owned()],
        )
    };
    let all: Vec<[String; 2]> = scopes.iter().map(|scope| split(scope)).collect();
    let line = |nth: usize| {
        cut_apart(&all.iter().map(|lines| lines[nth].as_str()).collect::<Vec<_>>(), TICK, wide)
    };
    std::iter::zip(line(0), line(1)).map(|(one, other)| [one, other]).collect()
}

/// All that a diagram shows, for its scale.
fn heights(statistic: &StatisticResult, figure: &RegressionFigure) -> Vec<f64> {
    let points = figure.points.iter().map(|point| point.y);
    let curves = figure.curve.iter().flat_map(|at| [Some(at.fitted), at.bound]).flatten();
    points.chain(curves).chain(statistic.limit).chain([figure.value]).collect()
}

fn panel(
    canvas: &mut Canvas,
    frame: &Frame,
    quantity: &QuantityResult,
    (statistic, figure): (&StatisticResult, &RegressionFigure),
    zones: &Zones,
) {
    canvas.lines("target", TARGET, [frame.upright(figure.target)]);
    if let Some(limit) = statistic.limit {
        frame.limits(canvas, &[limit]);
    }
    let curve = &figure.curve;
    let fitted: Vec<_> = curve.iter().map(|at| frame.at(at.x, at.fitted)).collect();
    let bound: Vec<_> = curve.iter().filter_map(|at| Some(frame.at(at.x, at.bound?))).collect();
    canvas.curve("fit", FIT, &fitted);
    if bound.len() > 1 {
        canvas.curve("bound", BOUND, &bound);
    }
    frame.spine(canvas);
    let decimals = number::decimals(&quantity.unit, figure.points.iter().map(|point| point.y));
    for point in &figure.points {
        let zone = point.zone.as_deref();
        let title = format!(
            "{}, {}: {} at {}",
            point.section,
            point.signal,
            number::with_unit(&number::fixed(point.y, decimals), &quantity.unit),
            number::with_unit(&number::significant(point.x, 4), &figure.regressor_unit)
        );
        let group = Group { class: "mark point", ..Group::mark(&title) }.edge(0.3);
        canvas.group(&group.at(&point.section, zone), |canvas| {
            canvas.mark(zones.mark(zone), frame.at(point.x, point.y), 1.6);
        });
    }
    let says = format!(
        "{} ({}): {}",
        statistic.title,
        statistic.scope,
        number::with_unit(&number::fixed(figure.value, decimals), &quantity.unit)
    );
    canvas.group(&Group::mark(&says).edge(0.3), |canvas| {
        canvas.mark(ESTIMATE, frame.at(figure.target, figure.value), 2.2);
    });
}
