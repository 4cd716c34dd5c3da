//! Differences (or values of a metric) by section, with mean, standard deviation and limits.

use indexmap::IndexMap;

use super::{kit::*, levels::Levels, pair_mark::Pairs, zones::Marks};
use crate::result::{QuantityResult, Scope};

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

    /// Consecutive sections with the same property of their zone, with the first and the end of
    /// their slots.
    fn runs<T: PartialEq>(&self, of: impl Fn(Option<&'a str>) -> T) -> Vec<(T, f64, f64)> {
        let mut runs: Vec<(T, f64, f64)> = Vec::new();
        for (slot, zone) in self.sections.values().enumerate() {
            let (of, end) = (of(*zone), (slot + 1) as f64);
            match runs.last_mut() {
                Some(run) if run.0 == of => run.2 = end,
                _ => runs.push((of, slot as f64, end)),
            }
        }
        runs
    }

    /// The slots of consecutive sections of a scope.
    fn within(&self, scope: &Scope) -> impl Iterator<Item = (f64, f64)> {
        let runs = self.runs(|zone| scope.has_zone(zone)).into_iter();
        runs.filter(|(inside, ..)| *inside).map(|(_, from, to)| (from, to))
    }
}

/// Reference levels and marks.
#[derive(Clone, Copy, Debug)]
pub struct Against<'a> {
    pub marks: &'a Marks<'a>,
    pub levels: &'a Levels,
    pub slots: &'a Slots<'a>,
}

/// The range of all differences, levels and zero.
pub fn range(quantity: &QuantityResult, levels: &Levels) -> Range {
    let differences = quantity.values.iter().map(|pair| pair.difference);
    axis::over(differences.chain(levels.values()).chain([0.0]))
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
    let x = (0.0, slots.sections.len().max(1) as f64);
    let frame = Frame::new(x, range(quantity, levels), (left, WIDTH - 2.0), (top, bottom));
    for band in &levels.bands {
        canvas.group(&Group::class("band"), |canvas| {
            for (from, to) in slots.within(&band.scope) {
                canvas.rect(frame.at(from, band.low), frame.at(to, band.high), SHADE);
            }
        });
    }
    let what = match (quantity.has_sides, &quantity.from) {
        (true, _) => number::formula(&quantity.comparison),
        (false, Some(side)) => format!("{side} value"),
        (false, None) => "value of the metric".to_owned(),
    };
    frame.y_axis(canvas, TICKS, &axis::title(&what, &quantity.unit));
    names(canvas, &frame, slots);
    zone_heads(canvas, &frame, slots);
    let (from, to) = frame.across(0.0);
    canvas.line(from, to, MUTED, 0.6);
    for line in &levels.lines {
        let runs = slots.within(&line.scope);
        let lines = runs.map(|(from, to)| (frame.at(from, line.value), frame.at(to, line.value)));
        canvas.lines("level", line.pen, lines);
    }
    frame.spine(canvas);
    let pairs = Pairs::new(quantity);
    for pair in &quantity.values {
        let at = frame.at(slots.place(&pair.section, &pair.signal), pair.difference);
        pairs.draw(canvas, pair, marks.mark(pair), at, 1.8);
    }
    if quantity.values.is_empty() {
        frame.empty(canvas, "no values", &Font::middle(TEXT).color(MUTED));
    }
}

/// Section names below the axis: horizontal if they fit, else rotated; only every n-th if slots are
/// narrower than the text.
fn names(canvas: &mut Canvas, frame: &Frame, slots: &Slots<'_>) {
    let wide = frame.x.at(1.0) - frame.x.at(0.0);
    let upright = slots.sections.keys().all(|name| text_width(name, TICK) < wide - 2.0);
    let every = if upright { 1 } else { (SMALL * 0.98 / wide).ceil().max(1.0) as usize };
    let (room, bottom) = (slots.names(), frame.bottom());
    for (slot, name) in slots.sections.keys().enumerate().step_by(every) {
        let x = frame.x.at(slot as f64 + 0.5);
        canvas.line((x, bottom), (x, bottom + 2.0), MUTED, 0.5);
        if upright {
            canvas.text(name, (x, bottom + 7.0), &Font::middle(TICK).color(MUTED));
        } else {
            let font = Font::right(SMALL).color(MUTED).upward();
            canvas.text(&cut(name, SMALL, room), (x, bottom + 4.0), &font);
        }
    }
    let below = bottom + if upright { 18.0 } else { room + 11.0 };
    canvas.text("section", (frame.center().0, below), &Font::middle(TEXT));
}

/// Zones above the diagram, separated by thin lines.
fn zone_heads(canvas: &mut Canvas, frame: &Frame, slots: &Slots<'_>) {
    let runs = slots.runs(Option::unwrap_or_default);
    if runs.len() > RUNS || runs.iter().all(|(zone, ..)| zone.is_empty()) {
        return;
    }
    let top = frame.top();
    for (zone, from, to) in runs {
        let (left, right) = (frame.x.at(from), frame.x.at(to));
        if from > 0.0 {
            canvas.line((left, top - 9.0), (left, frame.bottom()), GRID, 0.8);
        }
        let mut text = format!("zone {zone}");
        if text_width(&text, TICK) >= right - left {
            text = cut(zone, TICK, right - left);
        }
        let font = Font::middle(TICK).color(MUTED);
        canvas.text(&text, (f64::midpoint(left, right), top - 5.0), &font);
    }
}
