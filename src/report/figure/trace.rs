//! Simulated and measured signal over distance or time.

use super::axis::{self, Scale};
use super::canvas::{Canvas, Font, Group};
use super::frame::Frame;
use super::legend::{Entry, Legend};
use super::style::{
    BLUE, DASH_DOT, DASHED, DOTTED, Dash, INK, MEASURED, SHADE, SOLID, TEXT, WIDTH, color,
};
use crate::result::{Curve, Trace};

const HEIGHT: f64 = 128.0;

/// The signals that there are, by the names of the sides: the measured one wide and light, the
/// simulated thin and dark on top of it, the evaluated section shaded.
pub fn trace(trace: &Trace, (simulated, measured): (&str, &str)) -> String {
    let mut drawn = vec![
        ("curve measured", measured, &trace.measured, MEASURED, 1.8),
        ("curve simulated", simulated, &trace.simulated, BLUE, 0.8),
    ];
    // Of several records, each has its name.
    let name = trace.record.as_deref().filter(|_| !trace.others.is_empty());
    drawn.iter_mut().for_each(|(_, says, ..)| *says = name.unwrap_or(says));
    // An assessment has one side; alone, it is drawn dark.
    if drawn.iter().any(|(_, _, curve, ..)| !curve.y.is_empty()) {
        drawn.retain(|(_, _, curve, ..)| !curve.y.is_empty());
    }
    if let [(.., color, width)] = drawn.as_mut_slice() {
        (*color, *width) = (BLUE, 0.8);
    }
    let mut entries: Vec<Entry> = drawn
        .iter()
        .map(|(_, says, _, color, width)| Entry::line(*color, *width, SOLID, *says))
        .collect();
    let others: Vec<_> = trace
        .others
        .iter()
        .enumerate()
        .map(|(at, (name, curve))| (name, curve, color(at + 1), dash(at)))
        .collect();
    entries.extend(
        others.iter().map(|(name, _, color, dash)| Entry::line(*color, 0.8, *dash, name.as_str())),
    );
    entries.push(Entry::ground(SHADE, "evaluated section"));
    let legend = Legend::new(entries, WIDTH - 50.0);
    let top = legend.height() + 5.0;
    let bottom = top + HEIGHT;
    let curves: Vec<&Curve> = [&trace.measured, &trace.simulated]
        .into_iter()
        .chain(trace.others.iter().map(|(_, curve)| curve))
        .collect();
    let y = Scale::over(curves.iter().flat_map(|curve| curve.y.iter().copied()), bottom, top);
    let ticks = y.ticks(6);
    let left = Frame::axis_room(&ticks);
    let along =
        curves.iter().flat_map(|curve| curve.x.iter().copied()).chain([trace.start, trace.end]);
    let (low, high) = axis::extent(along).unwrap_or((0.0, 1.0));
    let frame = Frame { x: Scale { low, high, from: left, to: WIDTH - 6.0 }, y };
    let mut canvas = Canvas::new(WIDTH, bottom + 25.0);
    legend.draw(&mut canvas, (left, 0.0));
    canvas.group(&Group { class: "band", ..Group::default() }, |layer| {
        layer.rect((frame.x.at(trace.start), top), (frame.x.at(trace.end), bottom), SHADE);
    });
    frame.x_axis(&mut canvas, &frame.x.ticks(8), &axis::title(&trace.axis, &trace.axis_unit));
    frame.y_axis(&mut canvas, &ticks, &axis::title(&trace.signal, &trace.unit));
    for (_, curve, color, dash) in others {
        canvas.group(&Group { class: "curve other", dash, ..Group::default() }, |layer| {
            for piece in pieces(curve, &frame) {
                layer.path(&piece, color, 0.8);
            }
        });
    }
    for (class, _, curve, color, width) in drawn {
        canvas.group(&Group { class, ..Group::default() }, |layer| {
            for piece in pieces(curve, &frame) {
                layer.path(&piece, color, width);
            }
        });
    }
    if curves.iter().all(|curve| curve.y.is_empty()) {
        let middle = (f64::midpoint(frame.left(), frame.right()), f64::midpoint(top, bottom));
        canvas.draw(|layer| layer.text("no samples", middle, &Font::middle(TEXT).color(INK)));
    }
    frame.spine(&mut canvas);
    canvas.finish()
}

/// The line of the n-th of the other records.
fn dash(nth: usize) -> Dash {
    [DASHED, DOTTED, DASH_DOT][nth % 3]
}

/// The curve on the canvas, interrupted at missing values.
fn pieces(curve: &Curve, frame: &Frame) -> Vec<Vec<(f64, f64)>> {
    let samples: Vec<(f64, f64)> = curve.x.iter().copied().zip(curve.y.iter().copied()).collect();
    samples
        .split(|(x, y)| !(x.is_finite() && y.is_finite()))
        .filter(|piece| !piece.is_empty())
        .map(|piece| piece.iter().map(|(x, y)| (frame.x.at(*x), frame.y.at(*y))).collect())
        .collect()
}
