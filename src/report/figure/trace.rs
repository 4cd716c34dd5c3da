//! Simulated and measured signal over distance or time.

use super::kit::*;
use crate::result::{Curve, Trace};

const HEIGHT: f64 = 128.0;

/// The signals that there are, by the names of the sides: the measured one wide and light, the
/// simulated thin and dark on top of it, the evaluated section shaded.
pub fn trace(trace: &Trace, (simulated, measured): (&str, &str)) -> String {
    let mut drawn = vec![
        ("curve measured", measured, &trace.measured, Pen::solid(MEASURED, 1.8)),
        ("curve simulated", simulated, &trace.simulated, Pen::solid(BLUE, 0.8)),
    ];
    // Of several records, each has its name.
    let name = trace.record.as_deref().filter(|_| !trace.others.is_empty());
    drawn.iter_mut().for_each(|(_, says, ..)| *says = name.unwrap_or(says));
    // An assessment has one side; alone, it is drawn dark.
    if drawn.iter().any(|(_, _, curve, _)| !curve.y.is_empty()) {
        drawn.retain(|(_, _, curve, _)| !curve.y.is_empty());
    }
    if let [(.., pen)] = drawn.as_mut_slice() {
        *pen = Pen::solid(BLUE, 0.8);
    }
    let others: Vec<_> = trace.others.iter().enumerate().map(other).collect();
    let mut entries: Vec<Entry> =
        drawn.iter().chain(&others).map(|(_, says, _, pen)| Entry::line(*pen, *says)).collect();
    entries.push(Entry::ground(SHADE, "evaluated section"));
    let legend = Legend::new(entries, WIDTH - 50.0);
    let curves = || others.iter().chain(&drawn).map(|(_, _, curve, _)| *curve);
    let (ticks, top) = (6, legend.height() + 5.0);
    let y = axis::over(curves().flat_map(|curve| curve.y.iter().copied()));
    let along = curves().flat_map(|curve| curve.x.iter().copied());
    let x = axis::extent(along.chain([trace.start, trace.end])).unwrap_or((0.0, 1.0));
    let frame = Frame::new(x, y, (axis::room(y, ticks), WIDTH - 6.0), (top, top + HEIGHT));
    let mut canvas = Canvas::new(WIDTH, frame.bottom() + 25.0);
    legend.draw(&mut canvas, (frame.left(), 0.0));
    canvas.group(&Group::class("band"), |canvas| {
        canvas.rect(frame.upright(trace.start).0, frame.upright(trace.end).1, SHADE);
    });
    frame.x_axis(&mut canvas, 8, &axis::title(&trace.axis, &trace.axis_unit));
    frame.y_axis(&mut canvas, ticks, &axis::title(&trace.signal, &trace.unit));
    for (class, _, curve, pen) in others.iter().chain(&drawn) {
        canvas.group(&Group { dash: pen.dash, ..Group::class(class) }, |canvas| {
            for piece in pieces(curve, &frame) {
                canvas.path(&piece, pen.color, pen.width);
            }
        });
    }
    if curves().all(|curve| curve.y.is_empty()) {
        frame.empty(&mut canvas, "no samples", &Font::middle(TEXT).color(INK));
    }
    frame.spine(&mut canvas);
    canvas.finish()
}

/// The curve of the n-th of the other records: its class, its name and its line.
fn other((n, (name, curve)): (usize, &(String, Curve))) -> (&'static str, &str, &Curve, Pen) {
    let dash = [DASHED, DOTTED, DASH_DOT][n % 3];
    ("curve other", name, curve, Pen { dash, ..Pen::solid(color(n + 1), 0.8) })
}

/// The curve on the canvas, interrupted at missing values.
fn pieces(curve: &Curve, frame: &Frame) -> Vec<Vec<(f64, f64)>> {
    let samples: Vec<(f64, f64)> = curve.x.iter().copied().zip(curve.y.iter().copied()).collect();
    samples
        .split(|(x, y)| !(x.is_finite() && y.is_finite()))
        .filter(|piece| !piece.is_empty())
        .map(|piece| piece.iter().map(|(x, y)| frame.at(*x, *y)).collect())
        .collect()
}
