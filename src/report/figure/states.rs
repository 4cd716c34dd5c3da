//! Figures of a diagnosis: normalised statistics before and after, and signals of the sections with
//! the largest gap.

use super::axis::{self, Scale};
use super::canvas::{Canvas, Font, Group};
use super::frame::Frame;
use super::legend::{Entry, Legend};
use super::style::{
    BEYOND, BLUE, DASHED, GRID, INK, MEASURED, Mark, SHADE, SMALL, SOLID, TEXT, VERMILION, WIDTH,
    cut_apart,
};
use crate::report::number;
use crate::result::Curve;
use crate::result::diagnosis::{Panel, Picture, Shrink};

const ROW: f64 = 19.0;
const NAMES: f64 = 108.0;

/// For each quantity the normalised mean and standard deviation, before and with the effects,
/// joined by a line; the limit is at 1.
pub fn before_after(shrink: &Shrink) -> String {
    let legend = Legend::new(
        vec![
            Entry::mark(Mark::Circle, VERMILION, "as simulated"),
            Entry::mark(Mark::Triangle, BLUE, "with the effects, sections excluded from the fit"),
        ],
        WIDTH - NAMES,
    );
    let top = legend.height() + 6.0;
    let bottom = top + ROW * shrink.quantities.len() as f64;
    let values = shrink.quantities.iter().flat_map(|quantity| {
        [
            quantity.normalised_std_before,
            quantity.normalised_std_after,
            quantity.normalised_mean_before,
            quantity.normalised_mean_after,
        ]
    });
    let high = values.flatten().fold(1.1, f64::max) * 1.05;
    let x = Scale { low: 0.0, high, from: NAMES, to: WIDTH - 8.0 };
    let frame = Frame { x, y: Scale { low: 0.0, high: 1.0, from: bottom, to: top } };
    let mut canvas = Canvas::new(WIDTH, bottom + 28.0);
    legend.draw(&mut canvas, (NAMES, 0.0));
    canvas.draw(|layer| layer.rect((x.at(1.0), top), (frame.right(), bottom), BEYOND));
    frame.x_axis(&mut canvas, &x.ticks(8), "statistic / limit");
    let ids: Vec<&str> = shrink.quantities.iter().map(|quantity| quantity.id.as_str()).collect();
    let ids = cut_apart(&ids, TEXT, NAMES - 34.0);
    for (at, quantity) in shrink.quantities.iter().enumerate() {
        let y = top + ROW * at as f64;
        canvas.draw(|layer| {
            layer.line((0.0, y), (frame.right(), y), GRID, 0.4);
            layer.text(&ids[at], (2.0, y + 0.5 * ROW), &Font::left(TEXT));
        });
        let pairs = [
            ("std", quantity.normalised_std_before, quantity.normalised_std_after, 0.3),
            ("mean", quantity.normalised_mean_before, quantity.normalised_mean_after, 0.7),
        ];
        for (name, before, after, share) in pairs {
            let (Some(before), Some(after)) = (before, after) else { continue };
            let y = y + ROW * share;
            let title = format!(
                "{}: {name} {} of its limit before, {} after",
                quantity.id,
                number::fixed(before, 3),
                number::fixed(after, 3)
            );
            canvas.group(
                &Group { class: "mark", title: Some(&title), ..Group::default() },
                |layer| {
                    layer.text(name, (NAMES - 4.0, y), &Font::right(SMALL));
                    layer.line((x.at(before), y), (x.at(after), y), INK, 0.6);
                    layer.mark(Mark::Circle, (x.at(before), y), 2.2, VERMILION);
                    layer.mark(Mark::Triangle, (x.at(after), y), 2.4, BLUE);
                },
            );
        }
    }
    canvas.group(&Group { class: "limit", dash: DASHED, ..Group::default() }, |layer| {
        layer.line((x.at(1.0), top), (x.at(1.0), bottom), INK, 0.9);
    });
    frame.spine(&mut canvas);
    canvas.finish()
}

// Two figures of two rows fit one page.
const PANEL: f64 = 92.0;
const BETWEEN: f64 = 40.0;

/// Channels of a section, two per row: measured wide and light, simulated thin, with the effects
/// thin and dark.
pub fn signals(picture: &Picture) -> String {
    let mut entries = vec![
        Entry::line(MEASURED, 2.0, SOLID, "measured"),
        Entry::line(VERMILION, 0.8, SOLID, "simulated"),
    ];
    if picture.panels.iter().any(|panel| !panel.improved.x.is_empty()) {
        entries.push(Entry::line(BLUE, 0.8, SOLID, "simulated with the effects"));
    }
    entries.push(Entry::ground(SHADE, "evaluated section"));
    let legend = Legend::new(entries, WIDTH - 50.0);
    let top = legend.height() + 6.0;
    let rows = picture.panels.len().div_ceil(2);
    let mut canvas = Canvas::new(WIDTH, top + rows as f64 * (PANEL + BETWEEN));
    legend.draw(&mut canvas, (40.0, 0.0));
    for (at, panel) in picture.panels.iter().enumerate() {
        let left = (at % 2) as f64 * 0.5 * WIDTH;
        let row = top + (at / 2) as f64 * (PANEL + BETWEEN);
        one(&mut canvas, picture, panel, left, row);
    }
    canvas.finish()
}

fn one(canvas: &mut Canvas, picture: &Picture, panel: &Panel, left: f64, top: f64) {
    let curves = [&panel.measured, &panel.simulated, &panel.improved];
    let bottom = top + PANEL;
    let y = Scale::over(curves.iter().flat_map(|curve| curve.y.iter().copied()), bottom, top);
    let ticks = y.ticks(5);
    let from = left + Frame::axis_room(&ticks);
    let (low, high) =
        axis::extent(curves.iter().flat_map(|curve| curve.x.iter().copied())).unwrap_or((0.0, 1.0));
    let frame = Frame { x: Scale { low, high, from, to: left + 0.5 * WIDTH - 8.0 }, y };
    let inside = |x: f64| frame.x.at(x.clamp(low, high));
    canvas.draw(|layer| {
        layer.rect((inside(picture.start), top), (inside(picture.end), bottom), SHADE)
    });
    frame.x_axis(canvas, &frame.x.ticks(5), &picture.axis);
    frame.y_axis(canvas, &ticks, &axis::title(&panel.channel, &panel.unit));
    let drawn: [(&str, &Curve, _, f64); 3] = [
        ("curve measured", &panel.measured, MEASURED, 2.0),
        ("curve simulated", &panel.simulated, VERMILION, 0.8),
        ("curve improved", &panel.improved, BLUE, 0.8),
    ];
    for (class, curve, color, width) in drawn {
        let points: Vec<(f64, f64)> =
            curve.x.iter().zip(&curve.y).map(|(x, y)| (frame.x.at(*x), frame.y.at(*y))).collect();
        if points.len() > 1 {
            canvas.group(&Group { class, ..Group::default() }, |layer| {
                layer.path(&points, color, width)
            });
        }
    }
    frame.spine(canvas);
}
