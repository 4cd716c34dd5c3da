//! Box plots of normalised statistics over all selections of sections, as in Götz and Polach,
//! Figures 5, 6 and 8.

use super::axis::{Scale, Tick};
use super::canvas::{Canvas, Font, Group};
use super::frame::Frame;
use super::legend::{Entry, Legend};
use super::style::{
    self, BEYOND, BLUE, DASHED, INK, MUTED, Mark, SHADE, SMALL, TEXT, VERMILION, WIDTH, text_width,
};
use super::symbol::symbol;
use crate::report::number;
use crate::result::study::{QuantitySpread, Spread, StatisticSpread};

/// Heights of the plotting area and of its labels, in points.
const PANEL: f64 = 130.0;
const LABELS: f64 = 22.0;
/// Distance of a number from a line, from its centre, in points.
const CLEAR: f64 = 3.8;
/// Maximum half width of a box, in points.
const HALF: f64 = 9.0;
/// Maximum of the scale; values beyond are cut at the frame and marked.
const FARTHEST: f64 = 3.0;

/// A figure of one kind of statistic: one labelled box for each quantity and scope.
struct Panel<'a> {
    of: Of,
    boxes: Vec<(String, &'a StatisticSpread, &'a QuantitySpread, Spread)>,
    /// Values have a sign, and the limit applies on both sides.
    signed: bool,
}

/// The statistics of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    Means,
    Deviations,
    Others,
}

impl Of {
    pub const ALL: [Self; 3] = [Self::Means, Self::Deviations, Self::Others];

    /// In the name of the figure.
    pub fn name(self) -> &'static str {
        match self {
            Self::Means => "mean",
            Self::Deviations => "std",
            Self::Others => "other",
        }
    }

    pub fn in_words(self) -> &'static str {
        match self {
            Self::Means => "Means",
            Self::Deviations => "Standard deviations",
            Self::Others => "Other statistics",
        }
    }

    fn axis(self) -> &'static str {
        match self {
            Self::Means => "mean / limit",
            Self::Deviations => "standard deviation / limit",
            Self::Others => "statistic / limit",
        }
    }

    /// Whether a statistic of this name is among them.
    pub fn has(self, statistic: &str) -> bool {
        match statistic {
            "mean" => self == Self::Means,
            "std" => self == Self::Deviations,
            _ => self == Self::Others,
        }
    }
}

/// Statistics of which there is something to draw, with the number of boxes.
pub fn drawn(quantities: &[QuantitySpread]) -> Vec<(Of, usize)> {
    let all = Of::ALL.into_iter().map(|of| (of, panel(quantities, of).boxes.len()));
    all.filter(|(_, boxes)| *boxes > 0).collect()
}

pub fn boxes(quantities: &[QuantitySpread], of: Of) -> String {
    let panel = panel(quantities, of);
    let legend = Legend::new(
        vec![
            Entry::ground(SHADE, "middle half of all selections"),
            Entry::line(VERMILION, 1.4, style::SOLID, "median"),
            Entry::mark(Mark::Diamond, VERMILION, "farthest outlier, with the number of outliers"),
            Entry::line(INK, 0.9, DASHED, "limit"),
        ],
        WIDTH - 40.0,
    );
    let top = legend.height() + 8.0;
    let mut canvas = Canvas::new(WIDTH, top + PANEL + LABELS + 2.0);
    legend.draw(&mut canvas, (40.0, 0.0));
    draw(&mut canvas, &panel, top);
    canvas.finish()
}

fn panel(quantities: &[QuantitySpread], of: Of) -> Panel<'_> {
    let statistics = quantities.iter().flat_map(|quantity| {
        quantity.statistics.iter().map(move |statistic| (quantity, statistic))
    });
    let one = |(quantity, statistic): (&'_ QuantitySpread, &'_ StatisticSpread)| {
        let mut label = quantity.symbol.clone();
        if of == Of::Others {
            label = format!("{label} {}", statistic.name);
        }
        if statistic.scope != "all" {
            label = format!("{label}, {}", statistic.scope);
        }
        label
    };
    let boxes: Vec<_> = statistics
        .filter(|(_, statistic)| of.has(&statistic.name))
        .filter_map(|(quantity, statistic)| {
            Some((one((quantity, statistic)), statistic, quantity, statistic.spread?))
        })
        .collect();
    let signed = match of {
        Of::Means => true,
        Of::Deviations => false,
        Of::Others => boxes.iter().any(|(.., spread)| spread.min < 0.0),
    };
    Panel { of, boxes, signed }
}

fn draw(canvas: &mut Canvas, panel: &Panel<'_>, top: f64) {
    let ends = panel.boxes.iter().flat_map(|(.., spread)| [spread.min, spread.max]);
    let low = ends.clone().fold(if panel.signed { -1.15 } else { 0.0 }, f64::min).max(-FARTHEST);
    let high = ends.fold(1.15, f64::max).min(FARTHEST);
    let room = 0.04 * (high - low);
    let low = if panel.signed { low - room } else { 0.0 };
    let y = Scale { low, high: high + room, from: top + PANEL, to: top };
    let ticks: Vec<Tick> = y.ticks(7);
    let left = Frame::axis_room(&ticks).max(36.0);
    let frame = Frame {
        x: Scale { low: 0.0, high: panel.boxes.len() as f64, from: left, to: WIDTH - 4.0 },
        y,
    };
    beyond(canvas, &frame, panel.signed);
    frame.y_axis(canvas, &ticks, panel.of.axis());
    canvas.group(&Group { class: "limit", dash: DASHED, ..Group::default() }, |layer| {
        for limit in if panel.signed { &[-1.0, 1.0][..] } else { &[1.0][..] } {
            layer.line(
                (frame.left(), frame.y.at(*limit)),
                (frame.right(), frame.y.at(*limit)),
                INK,
                0.9,
            );
        }
    });
    let width = (frame.right() - frame.left()) / panel.boxes.len() as f64;
    let size = if width < 24.0 { SMALL } else { TEXT };
    for (at, (label, statistic, quantity, spread)) in panel.boxes.iter().enumerate() {
        let x = frame.x.at(at as f64 + 0.5);
        let title = format!(
            "{}, {}: least {}, quartiles {}, {}, {}, greatest {}, {} outliers",
            quantity.title,
            statistic.title,
            number::fixed(spread.min, 3),
            number::fixed(spread.q1, 3),
            number::fixed(spread.median, 3),
            number::fixed(spread.q3, 3),
            number::fixed(spread.max, 3),
            number::large(spread.outliers as f64)
        );
        canvas.group(&Group { class: "mark", title: Some(&title), ..Group::default() }, |layer| {
            one(layer, &frame, x, HALF.min(0.32 * width), spread);
        });
        canvas.draw(|layer| {
            let down = if at % 2 == 1 && text_width(label, size) > width { 17.0 } else { 8.0 };
            symbol(layer, label, (x, frame.bottom() + down), size, 1.9 * width);
        });
    }
    frame.spine(canvas);
}

/// A box, its whiskers and the farthest outlier on each side.
fn one(layer: &mut super::canvas::Layer<'_>, frame: &Frame, x: f64, half: f64, spread: &Spread) {
    let place = |value: f64| frame.y.at(value).clamp(frame.top(), frame.bottom());
    let (low, high) = spread.whiskers();
    layer.line((x, place(low)), (x, place(spread.q1)), INK, 0.6);
    layer.line((x, place(spread.q3)), (x, place(high)), INK, 0.6);
    for end in [low, high] {
        if frame.y.contains(end) {
            layer.line((x - 0.5 * half, place(end)), (x + 0.5 * half, place(end)), INK, 0.6);
        }
    }
    layer.rect((x - half, place(spread.q1)), (x + half, place(spread.q3)), SHADE);
    let corners = [
        (-half, spread.q1),
        (half, spread.q1),
        (half, spread.q3),
        (-half, spread.q3),
        (-half, spread.q1),
    ];
    layer.path(&corners.map(|(dx, value)| (x + dx, place(value))), BLUE, 0.9);
    layer.line((x - half, place(spread.median)), (x + half, place(spread.median)), VERMILION, 1.4);
    if spread.outliers > 0 {
        for (outlier, whisker) in [(spread.min, low), (spread.max, high)] {
            if outlier != whisker {
                layer.mark(Mark::Diamond, (x, place(outlier)), 1.7, VERMILION);
            }
        }
        // Above the largest value, and above the line of a limit.
        let above = (place(spread.max.max(high)) - 5.0).max(frame.top() - 3.0);
        let lines = [1.0, -1.0].map(|limit| frame.y.at(limit));
        let across = lines.into_iter().find(|line| (above - line).abs() < CLEAR);
        layer.text(
            &number::large(spread.outliers as f64).replace('\u{202f}', " "),
            (x, across.map_or(above, |line| line - CLEAR)),
            &Font::middle(4.6).color(MUTED),
        );
    }
}

/// Background of the range beyond the limits.
fn beyond(canvas: &mut Canvas, frame: &Frame, signed: bool) {
    canvas.draw(|layer| {
        layer.rect((frame.left(), frame.top()), (frame.right(), frame.y.at(1.0)), BEYOND);
        if signed {
            layer.rect((frame.left(), frame.y.at(-1.0)), (frame.right(), frame.bottom()), BEYOND);
        }
    });
}
