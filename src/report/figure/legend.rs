//! A legend of marks, lines and backgrounds, wrapped to the width of the figure.

use super::{
    canvas::{Canvas, Font, Group, Point},
    style::{Color, Mark, Pen, TEXT, cut, text_width},
};

/// Height of a row, in points.
const ROW: f64 = 11.5;
const KEY: f64 = 15.0;
const GAP: f64 = 12.0;

/// One entry: a sign and its meaning.
#[derive(Clone, Debug)]
pub struct Entry {
    pub sign: Sign,
    pub text: String,
}

/// What stands before the text of an entry.
#[derive(Clone, Copy, Debug)]
pub enum Sign {
    Mark(Mark, Color),
    Line(Pen),
    Ground(Color),
}

impl Entry {
    /// Of a mark.
    pub fn mark((mark, color): (Mark, Color), text: impl Into<String>) -> Self {
        Self { sign: Sign::Mark(mark, color), text: text.into() }
    }

    /// Of a line.
    pub fn line(pen: Pen, text: impl Into<String>) -> Self {
        Self { sign: Sign::Line(pen), text: text.into() }
    }

    /// Of a background.
    pub fn ground(color: Color, text: impl Into<String>) -> Self {
        Self { sign: Sign::Ground(color), text: text.into() }
    }

    fn key(&self) -> f64 {
        if matches!(self.sign, Sign::Mark(..)) { 9.0 } else { KEY + 4.0 }
    }
}

/// Entries with their positions.
#[derive(Debug)]
pub struct Legend {
    placed: Vec<(Point, Entry)>,
    rows: usize,
}

impl Legend {
    /// Arranges the entries in rows of a width, in points.
    pub fn new(entries: impl IntoIterator<Item = Entry>, width: f64) -> Self {
        let mut placed = Vec::new();
        let (mut x, mut row) = (0.0, 0);
        for entry in entries {
            let text = cut(&entry.text, TEXT, width - entry.key());
            let wide = entry.key() + text_width(&text, TEXT);
            if x > 0.0 && x + wide > width {
                (x, row) = (0.0, row + 1);
            }
            placed.push(((x, (row as f64 + 0.5) * ROW), Entry { text, ..entry }));
            x += wide + GAP;
        }
        Self { rows: if placed.is_empty() { 0 } else { row + 1 }, placed }
    }

    /// Height in points; 0 without entries.
    pub fn height(&self) -> f64 {
        self.rows as f64 * ROW
    }

    /// Draws with the upper left corner at a point.
    pub fn draw(&self, canvas: &mut Canvas, (left, top): Point) {
        for ((x, y), entry) in &self.placed {
            let (x, y) = (left + x, top + y);
            match entry.sign {
                Sign::Line(pen) => canvas.lines("key", pen, [((x, y), (x + KEY, y))]),
                Sign::Mark(mark, color) => canvas.group(&Group::class("key"), |canvas| {
                    canvas.mark((mark, color), (x + 3.5, y), 2.6);
                }),
                Sign::Ground(color) => canvas.group(&Group::class("key"), |canvas| {
                    canvas.rect((x, y - 3.5), (x + KEY, y + 3.5), color);
                }),
            }
            canvas.text(&entry.text, (x + entry.key(), y), &Font::left(TEXT));
        }
    }
}
