//! Sensitivity of metrics: rms change of value / limit over the size of a disturbance.

use super::axis::Scale;
use super::canvas::{Canvas, Group};
use super::frame::Frame;
use super::legend::{Entry, Legend};
use super::style::{Mark, WIDTH, color, cut};
use crate::report::number;

/// Height of the drawing area, in points.
const PANEL: f64 = 130.0;
/// Largest number of curves that can be told apart; further metrics are in the table only.
const MOST: usize = 12;

/// One curve for each metric: its name, and pairs of size and sensitivity.
pub fn sensitivity(disturbance: &str, curves: &[(String, Vec<(f64, f64)>)]) -> String {
    let curves = &curves[..curves.len().min(MOST)];
    let entries = curves.iter().enumerate().map(|(n, (name, _))| Entry::mark(Mark::nth(n), color(n), cut(name, 8.0, 0.45 * WIDTH)));
    let legend = Legend::new(entries.collect(), WIDTH - 40.0);
    let top = legend.height() + 8.0;
    let values = curves.iter().flat_map(|(_, points)| points.iter().map(|(_, value)| *value));
    let sizes = curves.iter().flat_map(|(_, points)| points.iter().map(|(size, _)| *size));
    let high = values.fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    let y = Scale { low: 0.0, high: 1.05 * high, from: top + PANEL, to: top };
    let ticks = y.ticks(6);
    let frame =
        Frame { x: Scale { low: 0.0, high: 1.05 * sizes.fold(0.0, f64::max), from: Frame::axis_room(&ticks), to: WIDTH - 10.0 }, y };
    let mut canvas = Canvas::new(WIDTH, top + PANEL + 30.0);
    legend.draw(&mut canvas, (40.0, 0.0));
    frame.y_axis(&mut canvas, &ticks, "rms change of value / limit");
    frame.x_axis(&mut canvas, &frame.x.ticks(8), &format!("size of the disturbance ({disturbance})"));
    for (n, (name, points)) in curves.iter().enumerate() {
        let placed: Vec<(f64, f64)> =
            [(0.0, 0.0)].iter().chain(points).map(|(size, value)| (frame.x.at(*size), frame.y.at(*value))).collect();
        canvas.draw(|layer| layer.path(&placed, color(n), 0.9));
        for ((size, value), point) in points.iter().zip(&placed[1..]) {
            let title = format!("{name}, size {size}: {}", number::significant(*value, 3));
            canvas.group(&Group { class: "mark", title: Some(&title), ..Group::default() }, |layer| {
                layer.mark(Mark::nth(n), *point, 2.0, color(n));
            });
        }
    }
    frame.spine(&mut canvas);
    canvas.finish()
}
