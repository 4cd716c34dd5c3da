//! A drawing in points, stored as SVG.
//!
//! Coordinates are whole steps of a grid that is finer than print resolution, so that the same
//! figure has the same bytes on every machine.

use std::fmt::{Arguments, Write as _};

use super::style::{Color, Dash, FAMILY, INK, Mark, Pen};
use crate::report::visible::visible;

/// Grid steps per point.
const STEPS: f64 = 20.0;
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

impl<'a> Group<'a> {
    /// Shapes of a class.
    pub fn class(class: &'a str) -> Self {
        Self { class, ..Self::default() }
    }

    /// A mark with its tooltip.
    pub fn mark(title: &'a str) -> Self {
        Self { title: Some(title), ..Self::class("mark") }
    }

    /// With a white outline of a width in points.
    pub fn edge(self, edge: f64) -> Self {
        Self { edge, ..self }
    }

    /// Identified for scripts by a section and its zone.
    pub fn at(self, section: &'a str, zone: Option<&'a str>) -> Self {
        Self { section: Some(section), zone, ..self }
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
    pub color: Color,
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

    /// Right-aligned at the point.
    pub fn right(size: f64) -> Self {
        Self { held: Held::End, ..Self::left(size) }
    }

    /// Centred at the point.
    pub fn middle(size: f64) -> Self {
        Self { held: Held::Middle, ..Self::left(size) }
    }

    /// In another colour.
    pub fn color(self, color: Color) -> Self {
        Self { color, ..self }
    }

    /// In bold type, or not.
    pub fn bold(self, bold: bool) -> Self {
        Self { bold, ..self }
    }

    /// Rotated to read upward.
    pub fn upward(self) -> Self {
        Self { upward: true, ..self }
    }
}

impl Canvas {
    /// An empty drawing; sizes in points.
    pub fn new(width: f64, height: f64) -> Self {
        Self { width, height, body: String::new() }
    }

    /// Draws shapes as a group.
    pub fn group(&mut self, group: &Group<'_>, draw: impl FnOnce(&mut Self)) {
        self.body.push_str("<g");
        self.attribute("class", (!group.class.is_empty()).then_some(group.class));
        self.attribute("data-section", group.section);
        self.attribute("data-zone", group.zone);
        if let Some(dash) = group.dash {
            let steps: Vec<String> = dash.iter().map(|length| step(*length).to_string()).collect();
            self.attribute("stroke-dasharray", Some(&steps.join(" ")));
        }
        if group.edge > 0.0 {
            self.attribute("stroke", Some("#FFFFFF"));
            self.attribute("stroke-width", Some(&step(group.edge).to_string()));
        }
        self.body.push('>');
        if let Some(title) = group.title {
            self.shape(format_args!("<title>{}</title>", escaped(title)));
        }
        draw(self);
        self.shape(format_args!("</g>"));
    }

    fn attribute(&mut self, name: &str, value: Option<&str>) {
        if let Some(value) = value {
            let _ = write!(self.body, " {name}=\"{}\"", escaped(value));
        }
    }

    fn shape(&mut self, text: Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.body, "{text}");
    }

    /// The finished SVG text, with its size in points.
    pub fn finish(self) -> String {
        let (width, height) = (step(self.width), step(self.height));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}pt\" height=\"{}pt\" viewBox=\"0 0 {width} {height}\">\n{}</svg>\n",
            f64::from(width) / STEPS,
            f64::from(height) / STEPS,
            self.body
        )
    }

    /// A straight line; the width in points.
    pub fn line(&mut self, from: Point, to: Point, color: Color, width: f64) {
        let ((x1, y1), (x2, y2), width) = (at(from), at(to), thick(width));
        self.shape(format_args!(
            "<line stroke=\"{color}\" stroke-width=\"{width}\" x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\"/>"
        ));
    }

    /// Straight lines of a pen, as a group of a class.
    pub fn lines(
        &mut self,
        class: &str,
        pen: Pen,
        lines: impl IntoIterator<Item = (Point, Point)>,
    ) {
        self.group(&Group { dash: pen.dash, ..Group::class(class) }, |canvas| {
            lines.into_iter().for_each(|(from, to)| canvas.line(from, to, pen.color, pen.width));
        });
    }

    /// A line through points.
    pub fn path(&mut self, points: &[Point], color: Color, width: f64) {
        self.shape(format_args!(
            "<polyline fill=\"none\" stroke=\"{color}\" stroke-width=\"{}\" points=\"{}\"/>",
            thick(width),
            listed(points)
        ));
    }

    /// A line of a pen through points, as a group of a class.
    pub fn curve(&mut self, class: &str, pen: Pen, points: &[Point]) {
        self.group(&Group { dash: pen.dash, ..Group::class(class) }, |canvas| {
            canvas.path(points, pen.color, pen.width);
        });
    }

    /// A filled polygon.
    pub fn fill(&mut self, points: &[Point], color: Color) {
        self.shape(format_args!("<polygon fill=\"{color}\" points=\"{}\"/>", listed(points)));
    }

    /// A filled rectangle between two corners.
    pub fn rect(&mut self, from: Point, to: Point, color: Color) {
        let (a, b) = (at(from), at(to));
        let (x, y, width, height) =
            (a.0.min(b.0), a.1.min(b.1), (a.0 - b.0).abs(), (a.1 - b.1).abs());
        self.shape(format_args!(
            "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{color}\" stroke=\"none\"/>"
        ));
    }

    /// A filled mark around a point; all shapes have approximately the same area.
    pub fn mark(&mut self, (mark, color): (Mark, Color), center: Point, radius: f64) {
        if mark == Mark::Circle {
            let ((x, y), radius) = (at(center), thick(radius));
            self.shape(format_args!(
                "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{color}\"/>"
            ));
        } else {
            self.fill(&outline(mark, center, radius), color);
        }
    }

    /// A text at a point.
    pub fn text(&mut self, text: &str, point: Point, font: &Font) {
        let ((x, y), size, color) = (at(point), step(font.size), font.color);
        let held = match font.held {
            Held::Start => "start",
            Held::Middle => "middle",
            Held::End => "end",
        };
        let weight = if font.bold { " font-weight=\"bold\"" } else { "" };
        let turned = match font.upward {
            true => format!(" transform=\"rotate(270, {x}, {y})\""),
            false => String::new(),
        };
        // Centred on half the height of capitals.
        self.shape(format_args!(
            "<text x=\"{x}\" y=\"{y}\" dy=\"0.35em\" text-anchor=\"{held}\" font-family=\"{FAMILY}\" font-size=\"{size}\" fill=\"{color}\"{weight}{turned}>{}</text>",
            escaped(text)
        ));
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

/// A width or a radius in steps; what is drawn is at least one step wide.
fn thick(length: f64) -> i32 {
    step(length).max(1)
}

fn step(length: f64) -> i32 {
    // The conversion saturates and maps NaN to 0; the clamp prevents overflow of sums of
    // coordinates.
    (length * STEPS).round().clamp(-FARTHEST, FARTHEST) as i32
}

fn at((x, y): Point) -> (i32, i32) {
    (step(x), step(y))
}

fn listed(points: &[Point]) -> String {
    let points: Vec<String> = points
        .iter()
        .map(|point| {
            let (x, y) = at(*point);
            format!("{x},{y}")
        })
        .collect();
    points.join(" ")
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
        canvas.group(&group, |canvas| canvas.text(hostile, (1.0, 2.0), &Font::left(8.0)));
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
        let pen = Pen { color: BLUE, width: 0.5, dash: DASHED };
        canvas.lines("", pen, [((0.0, 1.0), (1e300, f64::NAN))]);
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
