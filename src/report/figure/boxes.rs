//! Box plots of normalised statistics over all selections of sections, as in Götz and Polach,
//! Figures 5, 6 and 8.

use super::{kit::*, ratios::Ratios};
use crate::result::{
    StatisticName,
    study::{QuantitySpread, Spread, StatisticSpread},
};

/// Heights of the plotting area and of its labels, in points.
const PANEL: f64 = 130.0;
const LABELS: f64 = 22.0;
/// Distance of a number from a line, from its centre, in points.
const CLEAR: f64 = 3.8;
/// Maximum half width of a box, in points.
const HALF: f64 = 9.0;
/// The mark of the farthest outlier.
const OUTLIER: (Mark, Color) = (Mark::Diamond, VERMILION);
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
    pub fn has(self, statistic: &StatisticName) -> bool {
        match statistic {
            StatisticName::Mean => self == Self::Means,
            StatisticName::StandardDeviation => self == Self::Deviations,
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
        [
            Entry::ground(SHADE, "middle half of all selections"),
            Entry::line(Pen::solid(VERMILION, 1.4), "median"),
            Entry::mark(OUTLIER, "farthest outlier, with the number of outliers"),
            Entry::line(LIMIT, "limit"),
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
        label + &statistic.scope.suffix()
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
    let range = (if panel.signed { low - room } else { 0.0 }, high + room);
    let (slots, edges) = (panel.boxes.len(), (top, top + PANEL));
    let ratios = Ratios::new(canvas, (range, panel.signed), slots, edges, panel.of.axis());
    ratios.limits(canvas);
    for (at, (label, statistic, quantity, spread)) in panel.boxes.iter().enumerate() {
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
        let x = ratios.frame.x.at(at as f64 + 0.5);
        canvas.group(&Group::mark(&title), |canvas| {
            draw_box(canvas, &ratios.frame, x, HALF.min(0.32 * ratios.slot), spread);
        });
        ratios.label(canvas, at, label);
    }
    ratios.frame.spine(canvas);
}

/// A box, its whiskers and the farthest outlier on each side.
fn draw_box(canvas: &mut Canvas, frame: &Frame, x: f64, half: f64, spread: &Spread) {
    let place = |value: f64| frame.y.at(value).clamp(frame.top(), frame.bottom());
    let at = |dx: f64, value: f64| (x + dx, place(value));
    let (low, high) = spread.whiskers();
    canvas.line(at(0.0, low), at(0.0, spread.q1), INK, 0.6);
    canvas.line(at(0.0, spread.q3), at(0.0, high), INK, 0.6);
    for end in [low, high].into_iter().filter(|end| frame.y.contains(*end)) {
        canvas.line(at(-0.5 * half, end), at(0.5 * half, end), INK, 0.6);
    }
    canvas.rect(at(-half, spread.q1), at(half, spread.q3), SHADE);
    let corners = [(-half, spread.q1), (half, spread.q1), (half, spread.q3), (-half, spread.q3)];
    let outline = [corners[0], corners[1], corners[2], corners[3], corners[0]];
    canvas.path(&outline.map(|(dx, value)| at(dx, value)), BLUE, 0.9);
    canvas.line(at(-half, spread.median), at(half, spread.median), VERMILION, 1.4);
    if spread.outliers > 0 {
        for (outlier, whisker) in [(spread.min, low), (spread.max, high)] {
            if outlier != whisker {
                canvas.mark(OUTLIER, at(0.0, outlier), 1.7);
            }
        }
        // Above the largest value, and above the line of a limit.
        let above = (place(spread.max.max(high)) - 5.0).max(frame.top() - 3.0);
        let lines = [1.0, -1.0].map(|limit| frame.y.at(limit));
        let across = lines.into_iter().find(|line| (above - line).abs() < CLEAR);
        canvas.text(
            &number::large(spread.outliers as f64).replace('\u{202f}', " "),
            (x, across.map_or(above, |line| line - CLEAR)),
            &Font::middle(4.6).color(MUTED),
        );
    }
}
