//! Regressions of the values of groups: one small diagram for each group, in a row on the same
//! scale.

use super::axis::{self, Scale};
use super::canvas::{Canvas, Font, Group};
use super::frame::Frame;
use super::legend::{Entry, Legend};
use super::style::{
    self, BLUE, DASH_DOT, DASHED, DOTTED, INK, MUTED, Mark, SMALL, SOLID, TEXT, TICK, VERMILION,
    WIDTH, cut_apart, text_width,
};
use super::zones::Zones;
use crate::report::estimates::OfLimit;
use crate::report::number;
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
const TICKS: (usize, usize) = (5, 5);

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
    entries.push(Entry::line(BLUE, 1.2, SOLID, "regression"));
    entries.extend(bound.map(|bound| Entry::line(VERMILION, 1.1, DASH_DOT, bound)));
    entries.push(Entry::line(MUTED, 0.8, DOTTED, "target"));
    entries.push(Entry::mark(Mark::Diamond, INK, "estimate"));
    if groups.iter().any(|(one, _)| one.limit.is_some()) {
        entries.push(Entry::line(INK, 0.9, DASHED, "limit"));
    }
    let legend = Legend::new(entries, WIDTH - 40.0);
    let xs: Vec<f64> = curves().map(|at| at.x).collect();
    let tall = if groups.len() == 1 { TALL } else { LOW };
    let abreast = groups.len().clamp(1, ABREAST);
    let rows = groups.len().div_ceil(abreast);
    let top = legend.height() + 6.0;
    let narrow = (WIDTH - 4.0) / abreast as f64 - GUTTER;
    let scopes: Vec<&str> = groups.iter().map(|(statistic, _)| statistic.scope.as_str()).collect();
    let head = if scopes.iter().all(|scope| text_width(scope, TICK) <= narrow - AXIS) {
        HEAD
    } else {
        HEADS
    };
    let row = head + tall + FOOT;
    let of_row = |at: usize| {
        let ys = groups
            .iter()
            .skip(at * abreast)
            .take(abreast)
            .flat_map(|(one, figure)| heights(one, figure));
        Scale::over(ys, top + at as f64 * row + head + tall, top + at as f64 * row + head)
    };
    let left = (0..rows).map(|at| Frame::axis_room(&of_row(at).ticks(TICKS.1))).fold(0.0, f64::max);
    let wide = (WIDTH - 4.0 - left - GUTTER * (abreast as f64 - 1.0)) / abreast as f64;
    let mut canvas = Canvas::new(WIDTH, top + rows as f64 * row + 13.0);
    legend.draw(&mut canvas, (left, 0.0));
    let names = names(&scopes, wide);
    for (at, (statistic, figure)) in groups.iter().enumerate() {
        let from = left + (at % abreast) as f64 * (wide + GUTTER);
        let frame = Frame {
            x: Scale::over(xs.iter().copied(), from, from + wide),
            y: of_row(at / abreast),
        };
        axes(
            &mut canvas,
            &frame,
            (at % abreast == 0).then(|| axis::title(&quantity.symbol, &quantity.unit)).as_deref(),
        );
        canvas.draw(|layer| {
            for (up, line) in names[at].iter().rev().filter(|line| !line.is_empty()).enumerate() {
                let y = frame.top() - 6.0 - 8.0 * up as f64;
                layer.text(
                    line,
                    (f64::midpoint(frame.left(), frame.right()), y),
                    &Font::middle(TICK),
                );
            }
        });
        panel(&mut canvas, &frame, quantity, (statistic, figure), zones);
    }
    let title = groups
        .first()
        .map_or_else(String::new, |(_, one)| axis::title(&one.regressor, &one.regressor_unit));
    canvas.draw(|layer| {
        layer.text(
            &title,
            (f64::midpoint(left, WIDTH - 4.0), top + rows as f64 * row + 6.0),
            &Font::middle(TEXT),
        )
    });
    canvas.finish()
}

/// The name of each diagram in two lines of a width; the first holds as many parts as fit.
fn names(scopes: &[&str], wide: f64) -> Vec<[String; 2]> {
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

/// Axes whose x numbers stand without a title, since all diagrams have the same; y numbers only at
/// the first of a row.
fn axes(canvas: &mut Canvas, frame: &Frame, title: Option<&str>) {
    let ticks = frame.y.ticks(TICKS.1);
    match title {
        Some(title) => frame.y_axis(canvas, &ticks, title),
        None => canvas.draw(|layer| {
            for tick in &ticks {
                layer.line(
                    (frame.left(), frame.y.at(tick.value)),
                    (frame.right(), frame.y.at(tick.value)),
                    style::GRID,
                    0.5,
                );
            }
        }),
    }
    canvas.draw(|layer| {
        for tick in frame.x.ticks(TICKS.0) {
            let x = frame.x.at(tick.value);
            layer.line((x, frame.top()), (x, frame.bottom()), style::GRID, 0.5);
            layer.text(&tick.label, (x, frame.bottom() + 7.0), &Font::middle(SMALL).color(MUTED));
        }
    });
}

fn panel(
    canvas: &mut Canvas,
    frame: &Frame,
    quantity: &QuantityResult,
    (statistic, figure): (&StatisticResult, &RegressionFigure),
    zones: &Zones,
) {
    let target = frame.x.at(figure.target);
    canvas.group(&Group { class: "target", dash: DOTTED, ..Group::default() }, |layer| {
        layer.line((target, frame.top()), (target, frame.bottom()), MUTED, 0.8);
    });
    if let Some(limit) = statistic.limit {
        canvas.group(&Group { class: "limit", dash: DASHED, ..Group::default() }, |layer| {
            layer.line(
                (frame.left(), frame.y.at(limit)),
                (frame.right(), frame.y.at(limit)),
                INK,
                0.9,
            );
        });
    }
    let curve = |of: &dyn Fn(&crate::result::RegressionAt) -> Option<f64>| -> Vec<(f64, f64)> {
        figure.curve.iter().filter_map(|at| Some((frame.x.at(at.x), frame.y.at(of(at)?)))).collect()
    };
    let (fitted, bound) = (curve(&|at| Some(at.fitted)), curve(&|at| at.bound));
    canvas
        .group(&Group { class: "fit", ..Group::default() }, |layer| layer.path(&fitted, BLUE, 1.2));
    if bound.len() > 1 {
        canvas.group(&Group { class: "bound", dash: DASH_DOT, ..Group::default() }, |layer| {
            layer.path(&bound, VERMILION, 1.1)
        });
    }
    frame.spine(canvas);
    let decimals = number::decimals(&quantity.unit, figure.points.iter().map(|point| point.y));
    for point in &figure.points {
        let (mark, color) = zones.mark(point.zone.as_deref());
        let title = format!(
            "{}, {}: {} at {}",
            point.section,
            point.signal,
            number::with_unit(&number::fixed(point.y, decimals), &quantity.unit),
            number::with_unit(&number::significant(point.x, 4), &figure.regressor_unit)
        );
        let group = Group {
            class: "mark point",
            edge: 0.3,
            title: Some(&title),
            section: Some(&point.section),
            zone: point.zone.as_deref(),
            ..Group::default()
        };
        canvas.group(&group, |layer| {
            layer.mark(mark, (frame.x.at(point.x), frame.y.at(point.y)), 1.6, color)
        });
    }
    let says = format!(
        "{} ({}): {}",
        statistic.title,
        statistic.scope,
        number::with_unit(&number::fixed(figure.value, decimals), &quantity.unit)
    );
    canvas.group(
        &Group { class: "mark", title: Some(&says), edge: 0.3, ..Group::default() },
        |layer| {
            layer.mark(Mark::Diamond, (target, frame.y.at(figure.value)), 2.2, INK);
        },
    );
}
