//! A diagram of statistics divided by their limits, with a labelled slot for each of them.

use super::{kit::*, symbol::symbol};

/// Maximum number of ticks of the y axis.
const TICKS: usize = 7;

/// The diagram in progress; slots are 1 wide along the x axis.
#[derive(Debug)]
pub struct Ratios {
    pub frame: Frame,
    /// Values have a sign, and the limit applies on both sides.
    signed: bool,
    /// Width of a slot, in points.
    pub slot: f64,
}

impl Ratios {
    /// Draws the background beyond the limits and the axis of a range of values, between `top` and
    /// `bottom` in points.
    pub fn new(
        canvas: &mut Canvas,
        (range, signed): (Range, bool),
        slots: usize,
        edges: Range,
        title: &str,
    ) -> Self {
        let left = axis::room(range, TICKS).max(36.0);
        let frame = Frame::new((0.0, slots as f64), range, (left, WIDTH - 4.0), edges);
        frame.beyond(canvas, signed);
        frame.y_axis(canvas, TICKS, title);
        Self { frame, signed, slot: (frame.right() - frame.left()) / slots as f64 }
    }

    /// The lines of the limits.
    pub fn limits(&self, canvas: &mut Canvas) {
        self.frame.limits(canvas, if self.signed { &[-1.0, 1.0] } else { &[1.0] });
    }

    /// The name of a statistic below its slot; every second long name is lower.
    pub fn label(&self, canvas: &mut Canvas, slot: usize, label: &str) {
        let size = if self.slot < 24.0 { SMALL } else { TEXT };
        let low = slot % 2 == 1 && text_width(label, size) > self.slot;
        let y = self.frame.bottom() + if low { 17.0 } else { 8.0 };
        let at = (self.frame.x.at(slot as f64 + 0.5), y);
        symbol(canvas, label, at, &Font::middle(size), 1.9 * self.slot);
    }
}
