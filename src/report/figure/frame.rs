//! The frame of a diagram: axes with ticks, grid and titles, and lines and backgrounds along them.

use super::{
    axis::{Range, Scale, Tick, number_room},
    canvas::{Canvas, Font, Point},
    style::{BEYOND, GRID, INK, LIMIT, MUTED, TEXT, TICK},
};

/// The plotting area of a diagram with its two scales; y increases upward.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub x: Scale,
    pub y: Scale,
}

impl Frame {
    /// The ranges of both axes between the left and the right edge, and between the top and the
    /// bottom, in points.
    pub fn new(x: Range, y: Range, (left, right): Range, (top, bottom): Range) -> Self {
        Self { x: Scale::new(x, (left, right)), y: Scale::new(y, (bottom, top)) }
    }

    /// Rows without a y axis.
    pub fn rows(x: Range, across: Range, down: Range) -> Self {
        Self::new(x, (0.0, 1.0), across, down)
    }

    /// The left edge, in points.
    pub fn left(&self) -> f64 {
        self.x.from
    }

    /// The right edge, in points.
    pub fn right(&self) -> f64 {
        self.x.to
    }

    /// The upper edge, in points.
    pub fn top(&self) -> f64 {
        self.y.to
    }

    /// The lower edge, in points.
    pub fn bottom(&self) -> f64 {
        self.y.from
    }

    /// The middle of the area.
    pub fn center(&self) -> Point {
        (f64::midpoint(self.left(), self.right()), f64::midpoint(self.top(), self.bottom()))
    }

    /// Where two values are.
    pub fn at(&self, x: f64, y: f64) -> Point {
        (self.x.at(x), self.y.at(y))
    }

    /// The horizontal line at a value.
    pub fn across(&self, value: f64) -> (Point, Point) {
        let y = self.y.at(value);
        ((self.left(), y), (self.right(), y))
    }

    /// The vertical line at a value.
    pub fn upright(&self, value: f64) -> (Point, Point) {
        let x = self.x.at(value);
        ((x, self.top()), (x, self.bottom()))
    }

    /// Horizontal grid lines.
    pub fn y_grid(&self, canvas: &mut Canvas, most: usize) {
        for tick in self.y.ticks(most) {
            let (from, to) = self.across(tick.value);
            canvas.line(from, to, GRID, 0.5);
        }
    }

    /// Horizontal grid lines with at most so many numbers, and the title of the y axis.
    pub fn y_axis(&self, canvas: &mut Canvas, most: usize, title: &str) {
        let ticks = self.y.ticks(most);
        for tick in &ticks {
            let (from, to) = self.across(tick.value);
            canvas.line(from, to, GRID, 0.5);
            canvas.text(&tick.label, (from.0 - 3.5, from.1), &Font::right(TICK).color(MUTED));
        }
        let left = self.left() - number_room(&ticks) - 6.0;
        canvas.text(title, (left, self.center().1), &Font::middle(TEXT).upward());
    }

    /// Vertical grid lines with numbers of a size.
    pub fn x_numbers(&self, canvas: &mut Canvas, ticks: &[Tick], size: f64) {
        for tick in ticks {
            let (from, to) = self.upright(tick.value);
            canvas.line(from, to, GRID, 0.5);
            canvas.text(&tick.label, (to.0, to.1 + 7.0), &Font::middle(size).color(MUTED));
        }
    }

    /// Vertical grid lines with at most so many numbers, and the title of the x axis.
    pub fn x_axis(&self, canvas: &mut Canvas, most: usize, title: &str) {
        self.x_numbers(canvas, &self.x.ticks(most), TICK);
        self.x_title(canvas, title);
    }

    /// The title of the x axis.
    pub fn x_title(&self, canvas: &mut Canvas, title: &str) {
        canvas.text(title, (self.center().0, self.bottom() + 18.0), &Font::middle(TEXT));
    }

    /// The lines of both axes, drawn on top of the plot.
    pub fn spine(&self, canvas: &mut Canvas) {
        let (left, bottom) = (self.left(), self.bottom());
        canvas.path(&[(left, self.top()), (left, bottom), (self.right(), bottom)], INK, 0.7);
    }

    /// Lines of limits at values of y.
    pub fn limits(&self, canvas: &mut Canvas, values: &[f64]) {
        canvas.lines("limit", LIMIT, values.iter().map(|value| self.across(*value)));
    }

    /// Lines of limits at values of x.
    pub fn upright_limits(&self, canvas: &mut Canvas, values: impl IntoIterator<Item = f64>) {
        canvas.lines("limit", LIMIT, values.into_iter().map(|value| self.upright(value)));
    }

    /// The background of values of y above 1, and below -1 if they have a sign.
    pub fn beyond(&self, canvas: &mut Canvas, signed: bool) {
        canvas.rect((self.left(), self.top()), self.across(1.0).1, BEYOND);
        if signed {
            canvas.rect(self.across(-1.0).0, (self.right(), self.bottom()), BEYOND);
        }
    }

    /// The background of values of x above 1.
    pub fn beyond_right(&self, canvas: &mut Canvas) {
        canvas.rect(self.upright(1.0).0, (self.right(), self.bottom()), BEYOND);
    }

    /// Words in the middle of an empty diagram.
    pub fn empty(&self, canvas: &mut Canvas, says: &str, font: &Font) {
        canvas.text(says, self.center(), font);
    }
}
