//! A drawing in points, stored as SVG. plotters draws; this adds a grid finer than whole pixels,
//! dashes and groups.

use std::fmt::Write as _;

use plotters::backend::SVGBackend;
use plotters::prelude::DrawingBackend;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{
    Color, FontDesc, FontFamily, FontStyle, FontTransform, RGBColor, ShapeStyle, TextStyle,
};

use super::style::{Dash, FAMILY, INK, Mark};
use crate::report::visible::visible;

/// Grid steps per point: plotters rounds to whole steps; 1/20 pt is finer than print resolution.
const STEPS: f64 = 20.0;
/// plotters divides font sizes by this.
const FONT_SIZE_FACTOR: f64 = 1.24;
/// Coordinates are limited to this number of steps, far outside any figure.
const FARTHEST: f64 = 1e6;

/// A point on the canvas in points; x to the right, y downward.
pub type Point = (f64, f64);

/// A drawing in progress.
#[derive(Debug)]
pub struct Canvas {
    width: f64,
    height: f64,
    body: String,
}

/// Common properties of the shapes of a group.
#[derive(Clone, Copy, Debug, Default)]
pub struct Group<'a> {
    /// Class names for scripts and style sheets; not user text.
    pub class: &'a str,
    pub dash: Dash,
    /// Width of a white outline around filled shapes, in points.
    pub edge: f64,
    /// Tooltip text.
    pub title: Option<&'a str>,
    pub section: Option<&'a str>,
    pub zone: Option<&'a str>,
}

/// A group of shapes in progress.
pub struct Layer<'a> {
    backend: SVGBackend<'a>,
}

impl std::fmt::Debug for Layer<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Layer")
    }
}

/// Horizontal alignment of a text; vertically it is centred.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Held {
    Start,
    Middle,
    End,
}

/// Size, colour and alignment of a text.
#[derive(Clone, Copy, Debug)]
pub struct Font {
    pub size: f64,
    pub bold: bool,
    pub color: RGBColor,
    /// Alignment at the point.
    pub held: Held,
    /// Rotated to read upward.
    pub upward: bool,
}

impl Font {
    /// Left-aligned at the point.
    pub fn left(size: f64) -> Self {
        Self { size, bold: false, color: INK, held: Held::Start, upward: false }
    }

    pub fn right(size: f64) -> Self {
        Self { held: Held::End, ..Self::left(size) }
    }

    pub fn middle(size: f64) -> Self {
        Self { held: Held::Middle, ..Self::left(size) }
    }

    pub fn color(self, color: RGBColor) -> Self {
        Self { color, ..self }
    }

    pub fn bold(self, bold: bool) -> Self {
        Self { bold, ..self }
    }

    pub fn upward(self) -> Self {
        Self { upward: true, ..self }
    }
}

impl Canvas {
    /// An empty drawing; sizes in points.
    pub fn new(width: f64, height: f64) -> Self {
        Self { width, height, body: String::new() }
    }

    pub fn width(&self) -> f64 {
        self.width
    }

    /// Draws shapes without a group.
    pub fn draw(&mut self, draw: impl FnOnce(&mut Layer<'_>)) {
        let shapes = self.shapes(draw);
        self.body.push_str(&shapes);
    }

    /// Draws shapes as a group.
    pub fn group(&mut self, group: &Group<'_>, draw: impl FnOnce(&mut Layer<'_>)) {
        let shapes = self.shapes(draw);
        let body = &mut self.body;
        body.push_str("<g");
        attribute(body, "class", (!group.class.is_empty()).then_some(group.class));
        attribute(body, "data-section", group.section);
        attribute(body, "data-zone", group.zone);
        if let Some(dash) = group.dash {
            let steps: Vec<String> = dash.iter().map(|length| step(*length).to_string()).collect();
            attribute(body, "stroke-dasharray", Some(&steps.join(" ")));
        }
        if group.edge > 0.0 {
            attribute(body, "stroke", Some("#FFFFFF"));
            attribute(body, "stroke-width", Some(&step(group.edge).to_string()));
        }
        body.push('>');
        if let Some(title) = group.title {
            let _ = write!(body, "<title>{}</title>", escaped(title));
        }
        body.push('\n');
        body.push_str(&shapes);
        body.push_str("</g>\n");
    }

    fn shapes(&self, draw: impl FnOnce(&mut Layer<'_>)) -> String {
        let mut text = String::new();
        let size = (step(self.width) as u32, step(self.height) as u32);
        let mut layer = Layer { backend: SVGBackend::with_string(&mut text, size) };
        draw(&mut layer);
        // Writing to a string cannot fail.
        let _ = layer.backend.present();
        drop(layer);
        let start = text.find('\n').map_or(0, |at| at + 1);
        let end = text.rfind("</svg>").unwrap_or(text.len());
        // All quotes in texts are escaped, so these patterns are attributes. Full opacity is the
        // default; a filled shape takes the outline of its group; texts are centred on half the
        // x-height.
        whole_sizes(text.get(start..end).unwrap_or_default())
            .replace(" opacity=\"1\"", "")
            .replace(" stroke=\"none\" stroke-width=\"1\"", "")
            .replace("dy=\"0.5ex\"", "dy=\"0.35em\"")
            .replace("\n</text>", "</text>")
            .replace(" \"/>", "\"/>")
    }

    /// The finished SVG text, with its size in points.
    pub fn finish(self) -> String {
        let (width, height) = (step(self.width), step(self.height));
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}pt\" height=\"{}pt\" viewBox=\"0 0 {width} {height}\">\n",
            f64::from(width) / STEPS,
            f64::from(height) / STEPS
        );
        text.push_str(&self.body.replace("\">\n", "\">"));
        text.push_str("</svg>\n");
        text
    }
}

impl Layer<'_> {
    pub fn line(&mut self, from: Point, to: Point, color: RGBColor, width: f64) {
        let _ = self.backend.draw_line(at(from), at(to), &stroke(color, width));
    }

    pub fn path(&mut self, points: &[Point], color: RGBColor, width: f64) {
        let _ =
            self.backend.draw_path(points.iter().map(|point| at(*point)), &stroke(color, width));
    }

    pub fn fill(&mut self, points: &[Point], color: RGBColor) {
        let _ = self.backend.fill_polygon(points.iter().map(|point| at(*point)), &color.filled());
    }

    /// A filled rectangle between two corners.
    pub fn rect(&mut self, from: Point, to: Point, color: RGBColor) {
        let (a, b) = (at(from), at(to));
        let corners = ((a.0.min(b.0), a.1.min(b.1)), (a.0.max(b.0), a.1.max(b.1)));
        let _ = self.backend.draw_rect(corners.0, corners.1, &color.filled(), true);
    }

    /// A filled mark around a point; all shapes have approximately the same area.
    pub fn mark(&mut self, mark: Mark, center: Point, radius: f64, color: RGBColor) {
        if mark == Mark::Circle {
            let _ = self.backend.draw_circle(
                at(center),
                step(radius).max(1) as u32,
                &color.filled(),
                true,
            );
        } else {
            self.fill(&outline(mark, center, radius), color);
        }
    }

    pub fn text(&mut self, text: &str, point: Point, font: &Font) {
        let weight = if font.bold { FontStyle::Bold } else { FontStyle::Normal };
        let turned = if font.upward { FontTransform::Rotate270 } else { FontTransform::None };
        let size = (font.size * STEPS).round() * FONT_SIZE_FACTOR;
        let described = FontDesc::new(FontFamily::Name(FAMILY), size, weight).transform(turned);
        let held = match font.held {
            Held::Start => HPos::Left,
            Held::Middle => HPos::Center,
            Held::End => HPos::Right,
        };
        let style = TextStyle::from(described).color(&font.color).pos(Pos::new(held, VPos::Center));
        let _ = self.backend.draw_text(&visible(text), &style, at(point));
    }
}

/// The corners of a mark, clockwise from the top.
fn outline(mark: Mark, (x, y): Point, radius: f64) -> Vec<Point> {
    let (corners, turn, size) = match mark {
        Mark::Triangle => (3, 0.0, 1.35),
        Mark::TriangleDown => (3, 180.0, 1.35),
        Mark::Square => (4, 45.0, 1.25),
        Mark::Diamond => (4, 0.0, 1.3),
        Mark::Pentagon => (5, 0.0, 1.15),
        Mark::Hexagon => (6, 30.0, 1.1),
        Mark::Circle => (24, 0.0, 1.0),
        Mark::Bar => {
            let (half, tall) = (0.45 * radius, 1.5 * radius);
            return vec![
                (x - half, y - tall),
                (x + half, y - tall),
                (x + half, y + tall),
                (x - half, y + tall),
            ];
        }
    };
    (0..corners)
        .map(|corner| {
            let angle = (f64::from(corner) * 360.0 / f64::from(corners) + turn).to_radians();
            (x + size * radius * angle.sin(), y - size * radius * angle.cos())
        })
        .collect()
}

/// Removes rounding errors of font sizes that result from the factor of plotters.
fn whole_sizes(shapes: &str) -> String {
    const SIZE: &str = "font-size=\"";
    let mut pieces = shapes.split(SIZE);
    let mut text = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        text.push_str(SIZE);
        match piece.split_once('"').and_then(|(size, rest)| Some((size.parse::<f64>().ok()?, rest)))
        {
            Some((size, rest)) => {
                let _ = write!(text, "{}\"{rest}", size.round());
            }
            None => text.push_str(piece),
        }
    }
    text
}

fn stroke(color: RGBColor, width: f64) -> ShapeStyle {
    color.stroke_width(step(width).max(1) as u32)
}

fn step(length: f64) -> i32 {
    // The conversion saturates and maps NaN to 0; the clamp prevents overflow of sums of
    // coordinates.
    (length * STEPS).round().clamp(-FARTHEST, FARTHEST) as i32
}

fn at((x, y): Point) -> (i32, i32) {
    (step(x), step(y))
}

fn attribute(body: &mut String, name: &str, value: Option<&str>) {
    if let Some(value) = value {
        let _ = write!(body, " {name}=\"{}\"", escaped(value));
    }
}

/// Text escaped for XML content and attribute values.
pub fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in visible(text).chars() {
        match c {
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '&' => safe.push_str("&amp;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&apos;"),
            _ => safe.push(c),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::figure::style::{BLUE, DASHED};

    #[test]
    fn texts_of_users_stay_texts() {
        let hostile = "\"/><script>alert('1')</script>&\u{0}\u{1b}\u{202e}\n";
        let mut canvas = Canvas::new(100.0, 50.0);
        let group = Group {
            title: Some(hostile),
            section: Some(hostile),
            zone: Some(hostile),
            ..Group::default()
        };
        canvas.group(&group, |layer| layer.text(hostile, (1.0, 2.0), &Font::left(8.0)));
        let svg = canvas.finish();
        assert_eq!(svg.matches('<').count(), svg.matches('>').count());
        assert!(
            !svg.contains("<script")
                && !svg.contains('\u{0}')
                && !svg.contains('\u{1b}')
                && !svg.contains('\u{202e}'),
            "{svg}"
        );
        assert_eq!(svg.matches("&lt;script&gt;").count(), 4, "{svg}");
        assert_eq!(svg.matches("<text").count(), 1);
    }

    #[test]
    fn points_are_twenty_steps_and_nothing_overflows() {
        let mut canvas = Canvas::new(100.0, 50.0);
        canvas.group(&Group { dash: DASHED, ..Group::default() }, |layer| {
            layer.line((0.0, 1.0), (1e300, f64::NAN), BLUE, 0.5)
        });
        let svg = canvas.finish();
        assert!(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100pt\" height=\"50pt\" viewBox=\"0 0 2000 1000\">"));
        assert!(
            svg.contains("stroke-dasharray=\"100 50\"")
                && svg.contains("y1=\"20\"")
                && svg.contains("x2=\"1000000\""),
            "{svg}"
        );
    }
}
