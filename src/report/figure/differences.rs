//! Differences (or values of a metric) by section, with mean, standard deviation and limits.

use indexmap::IndexMap;

use super::axis::{self, Scale};
use super::canvas::{Canvas, Font, Group};
use super::frame::Frame;
use super::levels::{Levels, speaks_of};
use super::pair_mark::{pair_group, tooltip};
use super::style::{GRID, MUTED, SHADE, SMALL, TEXT, TICK, WIDTH, cut, text_width};
use super::zones::Marks;
use crate::report::number;
use crate::result::QuantityResult;

/// Maximum number of ticks of the y axis.
pub const TICKS: usize = 6;
/// Space for the longest section name, rotated, in points.
const NAME: f64 = 34.0;
/// Maximum number of runs of sections of one zone with a label above the diagram.
const RUNS: usize = 12;

/// The sections of a quantity in the order of its values, one slot each on the x axis.
#[derive(Debug)]
pub struct Slots<'a> {
    /// Section and zone.
    sections: IndexMap<&'a str, Option<&'a str>>,
    signals: IndexMap<&'a str, ()>,
}

impl<'a> Slots<'a> {
    pub fn of(quantity: &'a QuantityResult) -> Self {
        let mut sections = IndexMap::new();
        let mut signals = IndexMap::new();
        for pair in &quantity.values {
            sections.entry(pair.section.as_str()).or_insert(pair.zone.as_deref());
            signals.insert(pair.signal.as_str(), ());
        }
        Self { sections, signals }
    }

    /// Space below the axis for names and title, in points.
    pub fn room(&self) -> f64 {
        self.names() + 17.0
    }

    fn names(&self) -> f64 {
        self.sections.keys().map(|name| text_width(name, SMALL)).fold(8.0, f64::max).min(NAME)
    }

    /// Position of a pair: its section's slot, with the signals side by side.
    fn place(&self, section: &str, signal: &str) -> f64 {
        let slot = self.sections.get_index_of(section).unwrap_or(0) as f64;
        let nth = self.signals.get_index_of(signal).unwrap_or(0) as f64;
        slot + 0.5 + ((nth + 0.5) / self.signals.len().max(1) as f64 - 0.5) * 0.75
    }

    /// Slots from - to (exclusive) of consecutive sections with the same result.
    fn runs(&self, of: impl Fn(Option<&str>) -> bool) -> Vec<(usize, usize)> {
        let mut runs: Vec<(usize, usize)> = Vec::new();
        for (slot, _) in self.sections.values().enumerate().filter(|(_, zone)| of(**zone)) {
            match runs.last_mut() {
                Some(run) if run.1 == slot => run.1 += 1,
                _ => runs.push((slot, slot + 1)),
            }
        }
        runs
    }

    /// Consecutive sections of one zone.
    fn zone_runs(&self) -> Vec<(&'a str, usize, usize)> {
        let mut runs: Vec<(&str, usize, usize)> = Vec::new();
        for (slot, zone) in self.sections.values().enumerate() {
            let zone = zone.unwrap_or_default();
            match runs.last_mut() {
                Some(run) if run.0 == zone => run.2 = slot + 1,
                _ => runs.push((zone, slot, slot + 1)),
            }
        }
        runs
    }
}

/// Reference levels and marks.
#[derive(Clone, Copy, Debug)]
pub struct Against<'a> {
    pub marks: &'a Marks<'a>,
    pub levels: &'a Levels,
    pub slots: &'a Slots<'a>,
}

/// The scale over all differences, levels and zero.
pub fn scale(quantity: &QuantityResult, levels: &Levels, bottom: f64, top: f64) -> Scale {
    let differences = quantity.values.iter().map(|pair| pair.difference);
    Scale::over(differences.chain(levels.values()).chain([0.0]), bottom, top)
}

/// Draws the diagram from `left` to the right edge of the figure, between `top` and `bottom`, in
/// points.
pub fn draw(
    canvas: &mut Canvas,
    quantity: &QuantityResult,
    against: &Against<'_>,
    (left, top, bottom): (f64, f64, f64),
) {
    let Against { marks, levels, slots } = *against;
    let x =
        Scale { low: 0.0, high: slots.sections.len().max(1) as f64, from: left, to: WIDTH - 2.0 };
    let y = scale(quantity, levels, bottom, top);
    let frame = Frame { x, y };
    grounds(canvas, &frame, levels, slots);
    let formula = number::formula(&quantity.comparison);
    let what = match (quantity.has_sides, &quantity.from) {
        (true, _) => formula.clone(),
        (false, Some(side)) => format!("{side} value"),
        (false, None) => "value of the metric".to_owned(),
    };
    frame.y_axis(canvas, &y.ticks(TICKS), &axis::title(&what, &quantity.unit));
    names(canvas, &frame, slots);
    zone_heads(canvas, &frame, slots);
    lines(canvas, &frame, levels, slots);
    frame.spine(canvas);
    let decimals =
        number::decimals(&quantity.unit, quantity.values.iter().map(|pair| pair.difference));
    for pair in &quantity.values {
        let (mark, color) = marks.mark(pair);
        let title = tooltip(pair, quantity, decimals);
        canvas.group(&pair_group(pair, &title), |layer| {
            layer.mark(
                mark,
                (x.at(slots.place(&pair.section, &pair.signal)), y.at(pair.difference)),
                1.8,
                color,
            );
        });
    }
    if quantity.values.is_empty() {
        let middle = (f64::midpoint(left, x.to), f64::midpoint(top, bottom));
        canvas.draw(|layer| layer.text("no values", middle, &Font::middle(TEXT).color(MUTED)));
    }
}

fn grounds(canvas: &mut Canvas, frame: &Frame, levels: &Levels, slots: &Slots<'_>) {
    for band in &levels.bands {
        let runs = slots.runs(|zone| speaks_of(&band.scope, zone));
        canvas.group(&Group { class: "band", ..Group::default() }, |layer| {
            for (from, to) in runs {
                layer.rect(
                    (frame.x.at(from as f64), frame.y.at(band.low)),
                    (frame.x.at(to as f64), frame.y.at(band.high)),
                    SHADE,
                );
            }
        });
    }
}

fn lines(canvas: &mut Canvas, frame: &Frame, levels: &Levels, slots: &Slots<'_>) {
    let zero = frame.y.at(0.0);
    canvas.draw(|layer| layer.line((frame.left(), zero), (frame.right(), zero), MUTED, 0.6));
    for line in &levels.lines {
        let y = frame.y.at(line.value);
        let runs = slots.runs(|zone| speaks_of(&line.scope, zone));
        canvas.group(&Group { class: "level", dash: line.dash, ..Group::default() }, |layer| {
            for (from, to) in runs {
                layer.line(
                    (frame.x.at(from as f64), y),
                    (frame.x.at(to as f64), y),
                    line.color,
                    line.width,
                );
            }
        });
    }
}

/// Section names below the axis: horizontal if they fit, else rotated; only every n-th if slots are
/// narrower than the text.
fn names(canvas: &mut Canvas, frame: &Frame, slots: &Slots<'_>) {
    let wide = frame.x.at(1.0) - frame.x.at(0.0);
    let upright = slots.sections.keys().all(|name| text_width(name, TICK) < wide - 2.0);
    let every = if upright { 1 } else { (SMALL * 0.98 / wide).ceil().max(1.0) as usize };
    let room = slots.names();
    canvas.draw(|layer| {
        for (slot, name) in slots.sections.keys().enumerate().step_by(every) {
            let x = frame.x.at(slot as f64 + 0.5);
            layer.line((x, frame.bottom()), (x, frame.bottom() + 2.0), MUTED, 0.5);
            if upright {
                layer.text(name, (x, frame.bottom() + 7.0), &Font::middle(TICK).color(MUTED));
            } else {
                layer.text(
                    &cut(name, SMALL, room),
                    (x, frame.bottom() + 4.0),
                    &Font::right(SMALL).color(MUTED).upward(),
                );
            }
        }
        let below = frame.bottom() + if upright { 18.0 } else { room + 11.0 };
        layer.text(
            "section",
            (f64::midpoint(frame.left(), frame.right()), below),
            &Font::middle(TEXT),
        );
    });
}

/// Zones above the diagram, separated by thin lines.
fn zone_heads(canvas: &mut Canvas, frame: &Frame, slots: &Slots<'_>) {
    let runs = slots.zone_runs();
    if runs.len() > RUNS || runs.iter().all(|(zone, ..)| zone.is_empty()) {
        return;
    }
    canvas.draw(|layer| {
        for (zone, from, to) in runs {
            let (left, right) = (frame.x.at(from as f64), frame.x.at(to as f64));
            if from > 0 {
                layer.line((left, frame.top() - 9.0), (left, frame.bottom()), GRID, 0.8);
            }
            let long = format!("zone {zone}");
            let text = if text_width(&long, TICK) < right - left {
                long
            } else {
                cut(zone, TICK, right - left)
            };
            layer.text(
                &text,
                (f64::midpoint(left, right), frame.top() - 5.0),
                &Font::middle(TICK).color(MUTED),
            );
        }
    });
}
