//! Figures of a diagnosis: normalised statistics before and after, and signals of the sections with
//! the largest gap.

use super::kit::*;
use crate::result::diagnosis::{Panel, Picture, Shrink};

const ROW: f64 = 19.0;
const NAMES: f64 = 108.0;

const BEFORE: (Mark, Color) = (Mark::Circle, VERMILION);
const AFTER: (Mark, Color) = (Mark::Triangle, BLUE);

/// For each quantity the normalised mean and standard deviation, before and with the effects,
/// joined by a line; the limit is at 1.
pub fn before_after(shrink: &Shrink) -> String {
    let legend = Legend::new(
        [
            Entry::mark(BEFORE, "as simulated"),
            Entry::mark(AFTER, "with the effects, sections excluded from the fit"),
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
    let frame = Frame::rows((0.0, high), (NAMES, WIDTH - 8.0), (top, bottom));
    let mut canvas = Canvas::new(WIDTH, bottom + 28.0);
    legend.draw(&mut canvas, (NAMES, 0.0));
    frame.beyond_right(&mut canvas);
    frame.x_axis(&mut canvas, 8, "statistic / limit");
    let ids: Vec<&str> = shrink.quantities.iter().map(|quantity| quantity.id.as_str()).collect();
    let ids = cut_apart(&ids, TEXT, NAMES - 34.0);
    for (at, quantity) in shrink.quantities.iter().enumerate() {
        let y = top + ROW * at as f64;
        canvas.line((0.0, y), (frame.right(), y), GRID, 0.4);
        canvas.text(&ids[at], (2.0, y + 0.5 * ROW), &Font::left(TEXT));
        let pairs = [
            ("std", quantity.normalised_std_before, quantity.normalised_std_after, 0.3),
            ("mean", quantity.normalised_mean_before, quantity.normalised_mean_after, 0.7),
        ];
        for (name, before, after, share) in pairs {
            let (Some(before), Some(after)) = (before, after) else { continue };
            let title = format!(
                "{}: {name} {} of its limit before, {} after",
                quantity.id,
                number::fixed(before, 3),
                number::fixed(after, 3)
            );
            let at = |value: f64| (frame.x.at(value), y + ROW * share);
            canvas.group(&Group::mark(&title), |canvas| {
                canvas.text(name, (NAMES - 4.0, y + ROW * share), &Font::right(SMALL));
                canvas.line(at(before), at(after), INK, 0.6);
                canvas.mark(BEFORE, at(before), 2.2);
                canvas.mark(AFTER, at(after), 2.4);
            });
        }
    }
    frame.upright_limits(&mut canvas, [1.0]);
    frame.spine(&mut canvas);
    canvas.finish()
}

// Two figures of two rows fit one page.
const PANEL: f64 = 92.0;
const BETWEEN: f64 = 40.0;

const MEASURED_PEN: Pen = Pen::solid(MEASURED, 2.0);
const SIMULATED_PEN: Pen = Pen::solid(VERMILION, 0.8);
const IMPROVED_PEN: Pen = Pen::solid(BLUE, 0.8);

/// Channels of a section, two per row: measured wide and light, simulated thin, with the effects
/// thin and dark.
pub fn signals(picture: &Picture) -> String {
    let mut entries =
        vec![Entry::line(MEASURED_PEN, "measured"), Entry::line(SIMULATED_PEN, "simulated")];
    if picture.panels.iter().any(|panel| !panel.improved.x.is_empty()) {
        entries.push(Entry::line(IMPROVED_PEN, "simulated with the effects"));
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
        draw_panel(&mut canvas, picture, panel, left, row);
    }
    canvas.finish()
}

fn draw_panel(canvas: &mut Canvas, picture: &Picture, panel: &Panel, left: f64, top: f64) {
    let drawn = [
        ("curve measured", &panel.measured, MEASURED_PEN),
        ("curve simulated", &panel.simulated, SIMULATED_PEN),
        ("curve improved", &panel.improved, IMPROVED_PEN),
    ];
    let ticks = 5;
    let y = axis::over(drawn.iter().flat_map(|(_, curve, _)| curve.y.iter().copied()));
    let along = drawn.iter().flat_map(|(_, curve, _)| curve.x.iter().copied());
    let x = axis::extent(along).unwrap_or((0.0, 1.0));
    let across = (left + axis::room(y, ticks), left + 0.5 * WIDTH - 8.0);
    let frame = Frame::new(x, y, across, (top, top + PANEL));
    let (from, to) = (frame.x.within(picture.start), frame.x.within(picture.end));
    canvas.rect((from, top), (to, frame.bottom()), SHADE);
    frame.x_axis(canvas, ticks, &picture.axis);
    frame.y_axis(canvas, ticks, &axis::title(&panel.channel, &panel.unit));
    for (class, curve, pen) in drawn {
        let points: Vec<(f64, f64)> =
            curve.x.iter().zip(&curve.y).map(|(x, y)| frame.at(*x, *y)).collect();
        if points.len() > 1 {
            canvas.curve(class, pen, &points);
        }
    }
    frame.spine(canvas);
}
