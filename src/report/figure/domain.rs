//! The validity domain: the range of conditions of the sections used.

use indexmap::IndexSet;

use super::{kit::*, zones::Zones};
use crate::result::{DomainRange, SectionResult};

/// Height of one range, in points.
const BAR: f64 = 9.0;
/// Height of the scatter diagram, in points.
const SCATTER: f64 = 150.0;
/// Colour of sections not used.
const UNUSED: Color = MEASURED;
/// Distance between the two columns of panels, in points.
const GUTTER: f64 = 18.0;

/// The range of every condition by zone, with the values of its sections; and a scatter diagram of
/// the first two conditions that vary.
pub fn domain(ranges: &[DomainRange], sections: &[SectionResult], zones: &Zones) -> String {
    let names: IndexSet<(&str, &str)> =
        ranges.iter().map(|range| (range.name.as_str(), range.unit.as_str())).collect();
    let panels: Vec<Panel<'_>> =
        names.iter().map(|name| Panel::of(*name, ranges, sections)).collect();
    let across = scatter_pair(&panels);
    let mut entries = zones.legend(
        sections.iter().filter(|section| section.used).map(|section| section.zone.as_deref()),
    );
    if sections.iter().any(|section| !section.used) {
        entries.push(Entry::mark((Mark::Circle, UNUSED), "section not used"));
    }
    let legend = Legend::new(entries, WIDTH);
    let top = legend.height() + 6.0;
    let wide = (WIDTH - GUTTER) / 2.0;
    let row_heights: Vec<f64> =
        panels.chunks(2).map(|pair| pair.iter().map(Panel::height).fold(0.0, f64::max)).collect();
    let panels_height: f64 = row_heights.iter().sum();
    let height = top + panels_height + if across.is_some() { SCATTER + 40.0 } else { 0.0 };
    let mut canvas = Canvas::new(WIDTH, height.max(24.0));
    legend.draw(&mut canvas, (0.0, 0.0));
    let labels = panels
        .iter()
        .flat_map(|panel| &panel.scopes)
        .map(|range| text_width(&range.scope.to_string(), TICK))
        .fold(16.0, f64::max)
        .min(70.0);
    let mut y = top;
    for (pair, tall) in panels.chunks(2).zip(&row_heights) {
        for (column, panel) in pair.iter().enumerate() {
            let left = column as f64 * (wide + GUTTER);
            panel.draw(&mut canvas, zones, (left, left + wide - 4.0, y), labels);
        }
        y += tall;
    }
    if let Some((across, up)) = across {
        scatter(&mut canvas, (across, up), zones, y + 8.0);
    }
    if panels.is_empty() {
        let font = Font::left(TEXT).color(MUTED);
        canvas.text("no condition with numbers", (0.0, 12.0), &font);
    }
    canvas.finish()
}

/// One condition: its ranges, and the values of the sections.
struct Panel<'a> {
    name: &'a str,
    unit: &'a str,
    scopes: Vec<&'a DomainRange>,
    points: Vec<(&'a SectionResult, f64)>,
}

impl<'a> Panel<'a> {
    fn of(
        (name, unit): (&'a str, &'a str),
        ranges: &'a [DomainRange],
        sections: &'a [SectionResult],
    ) -> Self {
        let value = |section: &SectionResult| {
            let column = section.columns.iter().find(|column| column.name == name)?;
            column
                .value
                .trim()
                .replace('\u{2212}', "-")
                .parse::<f64>()
                .ok()
                .filter(|value| value.is_finite())
        };
        Self {
            name,
            unit,
            scopes: ranges
                .iter()
                .filter(|range| range.name == name && range.unit == unit)
                .collect(),
            points: sections
                .iter()
                .filter_map(|section| Some((section, value(section)?)))
                .collect(),
        }
    }

    fn height(&self) -> f64 {
        self.scopes.len() as f64 * BAR + 38.0
    }

    fn range(&self) -> Range {
        let ends = self.scopes.iter().flat_map(|range| [range.low, range.high]);
        axis::over(ends.chain(self.points.iter().map(|(_, value)| *value)))
    }

    fn draw(
        &self,
        canvas: &mut Canvas,
        zones: &Zones,
        (left, right, top): (f64, f64, f64),
        labels: f64,
    ) {
        let from = left + labels + 6.0;
        let bottom = top + 6.0 + self.scopes.len() as f64 * BAR;
        let frame = Frame::rows(self.range(), (from, right), (top, bottom));
        let title = cut(&axis::title(self.name, self.unit), TEXT, right - from);
        frame.x_axis(canvas, 5, &title);
        for (at, range) in self.scopes.iter().enumerate() {
            let y = top + 3.0 + (at as f64 + 0.5) * BAR;
            let zone = zones_of(range);
            let (mark, color) = zones.mark(zone);
            let (color, width) = if zone.is_none() { (INK, 1.6) } else { (color, 1.2) };
            let says = format!(
                "{}, {}: {} to {}, {} sections",
                self.name,
                range.scope,
                number::significant(range.low, 6),
                number::significant(range.high, 6),
                range.count
            );
            let font = Font::right(TICK).color(MUTED);
            canvas.text(&cut(&range.scope.to_string(), TICK, labels), (from - 4.0, y), &font);
            let group = Group { title: Some(&says), zone, ..Group::class("range") };
            canvas.group(&group, |canvas| {
                let ends = [range.low, range.high].map(|end| frame.x.at(end));
                canvas.line((ends[0], y), (ends[1], y), color, width);
                for end in ends {
                    canvas.line((end, y - 3.0), (end, y + 3.0), color, 1.0);
                }
            });
            for (section, value) in self
                .points
                .iter()
                .filter(|(section, _)| zone.is_some() && section.zone.as_deref() == zone)
            {
                let shown = number::significant(*value, 6);
                let says = format!("{}: {} {shown}", section.section, self.name);
                draw_section(canvas, section, &says, (mark, color), (frame.x.at(*value), y), 1.7);
            }
        }
        frame.spine(canvas);
    }
}

fn draw_section(
    canvas: &mut Canvas,
    section: &SectionResult,
    says: &str,
    (mark, color): (Mark, Color),
    at: Point,
    radius: f64,
) {
    let group = Group::mark(says).edge(0.35).at(&section.section, section.zone.as_deref());
    let color = if section.used { color } else { UNUSED };
    canvas.group(&group, |canvas| canvas.mark((mark, color), at, radius));
}

fn zones_of(range: &DomainRange) -> Option<&str> {
    range.scope.zones.first().map(String::as_str)
}

/// The first two conditions with at least three common sections and more than two values each.
fn scatter_pair<'p, 'a>(panels: &'p [Panel<'a>]) -> Option<(&'p Panel<'a>, &'p Panel<'a>)> {
    let varied: Vec<&Panel<'_>> = panels
        .iter()
        .filter(|panel| {
            let values: IndexSet<u64> =
                panel.points.iter().map(|(_, value)| value.to_bits()).collect();
            values.len() > 2
        })
        .collect();
    varied.iter().enumerate().find_map(|(at, first)| {
        let second = varied[at + 1..].iter().find(|second| together(first, second).len() >= 3)?;
        Some((*first, *second))
    })
}

/// Sections with both values.
fn together<'a>(first: &Panel<'a>, second: &Panel<'a>) -> Vec<(&'a SectionResult, f64, f64)> {
    first
        .points
        .iter()
        .filter_map(|(section, x)| {
            let (_, y) = second.points.iter().find(|(other, _)| std::ptr::eq(*other, *section))?;
            Some((*section, *x, *y))
        })
        .collect()
}

fn scatter(canvas: &mut Canvas, (across, up): (&Panel<'_>, &Panel<'_>), zones: &Zones, top: f64) {
    let (y, ticks) = (up.range(), 6);
    let edges = (axis::room(y, ticks), WIDTH - 6.0);
    let frame = Frame::new(across.range(), y, edges, (top, top + SCATTER));
    frame.x_axis(canvas, 8, &axis::title(across.name, across.unit));
    frame.y_axis(canvas, ticks, &axis::title(up.name, up.unit));
    frame.spine(canvas);
    for (section, x, y) in together(across, up) {
        let says = format!(
            "{}: {} {}, {} {}",
            section.section,
            across.name,
            number::significant(x, 6),
            up.name,
            number::significant(y, 6)
        );
        let look = zones.mark(section.zone.as_deref());
        draw_section(canvas, section, &says, look, frame.at(x, y), 2.2);
    }
}
