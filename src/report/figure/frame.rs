//! The frame of a diagram: axes with ticks, grid and titles.

use super::axis::{Scale, Tick};
use super::canvas::{Canvas, Font};
use super::style::{GRID, INK, MUTED, TEXT, TICK, text_width};

/// The plotting area of a diagram with its two scales; y increases upward.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub x: Scale,
    pub y: Scale,
}

impl Frame {
    pub fn left(&self) -> f64 {
        self.x.from
    }

    pub fn right(&self) -> f64 {
        self.x.to
    }

    pub fn top(&self) -> f64 {
        self.y.to
    }

    pub fn bottom(&self) -> f64 {
        self.y.from
    }

    /// Space of a y axis with numbers and title to its left, in points.
    pub fn axis_room(ticks: &[Tick]) -> f64 {
        Self::room_for(ticks) + 11.5
    }

    /// Space of the numbers alone.
    fn room_for(ticks: &[Tick]) -> f64 {
        ticks.iter().map(|tick| text_width(&tick.label, TICK)).fold(0.0, f64::max) + 5.0
    }

    /// Horizontal grid lines and the numbers and title of the y axis.
    pub fn y_axis(&self, canvas: &mut Canvas, ticks: &[Tick], title: &str) {
        let room = Self::room_for(ticks);
        canvas.draw(|layer| {
            for tick in ticks {
                let y = self.y.at(tick.value);
                layer.line((self.left(), y), (self.right(), y), GRID, 0.5);
                layer.text(&tick.label, (self.left() - 3.5, y), &Font::right(TICK).color(MUTED));
            }
            let middle = f64::midpoint(self.top(), self.bottom());
            layer.text(title, (self.left() - room - 6.0, middle), &Font::middle(TEXT).upward());
        });
    }

    /// Vertical grid lines and the numbers and title of the x axis.
    pub fn x_axis(&self, canvas: &mut Canvas, ticks: &[Tick], title: &str) {
        canvas.draw(|layer| {
            for tick in ticks {
                let x = self.x.at(tick.value);
                layer.line((x, self.top()), (x, self.bottom()), GRID, 0.5);
                layer.text(&tick.label, (x, self.bottom() + 7.0), &Font::middle(TICK).color(MUTED));
            }
            layer.text(
                title,
                (f64::midpoint(self.left(), self.right()), self.bottom() + 18.0),
                &Font::middle(TEXT),
            );
        });
    }

    /// The lines of both axes, drawn on top of the plot.
    pub fn spine(&self, canvas: &mut Canvas) {
        canvas.draw(|layer| {
            let corners = [
                (self.left(), self.top()),
                (self.left(), self.bottom()),
                (self.right(), self.bottom()),
            ];
            layer.path(&corners, INK, 0.7);
        });
    }
}
