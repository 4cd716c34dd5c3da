//! Study of offsets: normalised statistics of one selection (as Götz and Polach, Figure 7) and the
//! share validated.

use super::axis::{Scale, Tick};
use super::canvas::{Canvas, Group};
use super::frame::Frame;
use super::legend::{Entry, Legend};
use super::style::{BEYOND, BLUE, DASHED, INK, Mark, SMALL, TEXT, WIDTH, color, text_width};
use super::symbol::symbol;
use crate::report::number;
use crate::result::VerdictWords;
use crate::result::study::{AtOffset, SyncStudy};

const PANEL: f64 = 118.0;
const LABELS: f64 = 26.0;

/// Statistics of one selection: one mark per offset; one panel for means, one for all other
/// statistics.
pub fn selection(study: &SyncStudy) -> String {
    let entries = study
        .offsets
        .iter()
        .enumerate()
        .map(|(n, at)| Entry::mark(Mark::nth(n), color(n), name(study, at)));
    let legend = Legend::new(entries.collect(), WIDTH - 40.0);
    let top = legend.height() + 8.0;
    let of = |mean: bool| -> Vec<(usize, String)> {
        let Some(first) = study.offsets.iter().find(|at| !at.selected.is_empty()) else {
            return Vec::new();
        };
        let wanted =
            first.selected.iter().enumerate().filter(|(_, one)| (one.name == "mean") == mean);
        wanted
            .map(|(at, one)| {
                let scope =
                    if one.scope == "all" { String::new() } else { format!(", {}", one.scope) };
                let word = if one.name == "mean" || one.name == "std" {
                    String::new()
                } else {
                    format!(" {}", one.name)
                };
                (at, format!("{}{word}{scope}", one.symbol))
            })
            .collect()
    };
    let panels: Vec<_> =
        [("mean / limit", true, of(true)), ("standard deviation / limit", false, of(false))]
            .into_iter()
            .filter(|(.., statistics)| !statistics.is_empty())
            .collect();
    let mut canvas = Canvas::new(WIDTH, top + panels.len() as f64 * (PANEL + LABELS + 8.0));
    legend.draw(&mut canvas, (40.0, 0.0));
    for (at, (title, signed, statistics)) in panels.iter().enumerate() {
        panel(
            &mut canvas,
            study,
            (title, *signed),
            statistics,
            top + at as f64 * (PANEL + LABELS + 8.0),
        );
    }
    canvas.finish()
}

fn name(study: &SyncStudy, at: &AtOffset) -> String {
    number::with_unit(&number::significant(at.offset, 4), &study.axis_unit)
}

fn panel(
    canvas: &mut Canvas,
    study: &SyncStudy,
    (title, signed): (&str, bool),
    statistics: &[(usize, String)],
    top: f64,
) {
    let value =
        |at: &AtOffset, statistic: usize| at.selected.get(statistic).and_then(|one| one.normalised);
    let values = study
        .offsets
        .iter()
        .flat_map(|at| statistics.iter().filter_map(move |(statistic, _)| value(at, *statistic)));
    let high = values.clone().fold(1.1, f64::max).min(3.0);
    let low = if signed { values.fold(-1.1, f64::min).max(-3.0) } else { 0.0 };
    let y = Scale { low, high: high + 0.03 * (high - low), from: top + PANEL, to: top };
    let ticks = y.ticks(7);
    let frame = Frame {
        x: Scale {
            low: 0.0,
            high: statistics.len() as f64,
            from: Frame::axis_room(&ticks).max(36.0),
            to: WIDTH - 4.0,
        },
        y,
    };
    canvas.draw(|layer| {
        layer.rect((frame.left(), frame.top()), (frame.right(), y.at(1.0)), BEYOND);
        if signed {
            layer.rect((frame.left(), y.at(-1.0)), (frame.right(), frame.bottom()), BEYOND);
        }
    });
    frame.y_axis(canvas, &ticks, title);
    let width = (frame.right() - frame.left()) / statistics.len() as f64;
    let size = if width < 24.0 { SMALL } else { TEXT };
    let count = study.offsets.len().max(1) as f64;
    for (place, (statistic, label)) in statistics.iter().enumerate() {
        for (n, at) in study.offsets.iter().enumerate() {
            let Some(value) = value(at, *statistic) else { continue };
            let x = frame.x.at(place as f64 + 0.12 + 0.76 * (n as f64 + 0.5) / count);
            let shown = format!("{label}, {}: {}", name(study, at), number::fixed(value, 3));
            canvas.group(
                &Group { class: "mark", title: Some(&shown), ..Group::default() },
                |layer| {
                    layer.mark(Mark::nth(n), (x, y.at(value.clamp(y.low, y.high))), 1.6, color(n));
                },
            );
        }
        let down = if place % 2 == 1 && text_width(label, size) > width { 17.0 } else { 8.0 };
        canvas.draw(|layer| {
            symbol(
                layer,
                label,
                (frame.x.at(place as f64 + 0.5), frame.bottom() + down),
                size,
                1.9 * width,
            );
        });
    }
    canvas.group(&Group { class: "limit", dash: DASHED, ..Group::default() }, |layer| {
        for limit in if signed { &[-1.0, 1.0][..] } else { &[1.0][..] } {
            layer.line((frame.left(), y.at(*limit)), (frame.right(), y.at(*limit)), INK, 0.9);
        }
    });
    frame.spine(canvas);
}

/// The share of selections for which the verdict holds as a function of the offset.
pub fn shares(study: &SyncStudy, words: &VerdictWords) -> String {
    let points: Vec<(f64, f64)> = study
        .offsets
        .iter()
        .filter_map(|at| at.study.as_ref().ok().map(|found| (at.offset, 100.0 * found.share.share)))
        .collect();
    let y = Scale { low: 0.0, high: 103.0, from: 128.0, to: 8.0 };
    let ticks: Vec<Tick> = y.ticks(6);
    let frame = Frame {
        x: Scale::over(
            study.offsets.iter().map(|at| at.offset),
            Frame::axis_room(&ticks),
            WIDTH - 10.0,
        ),
        y,
    };
    let mut canvas = Canvas::new(WIDTH, 158.0);
    frame.y_axis(&mut canvas, &ticks, &format!("selections {} [%]", words.good));
    frame.x_axis(
        &mut canvas,
        &frame.x.ticks(10),
        &format!("offset of the measurement [{}]", number::unit(&study.axis_unit)),
    );
    let placed: Vec<(f64, f64)> =
        points.iter().map(|(offset, share)| (frame.x.at(*offset), y.at(*share))).collect();
    canvas.draw(|layer| layer.path(&placed, BLUE, 0.9));
    for ((offset, share), point) in points.iter().zip(placed) {
        let title = format!(
            "{} {}: {} %",
            number::significant(*offset, 4),
            study.axis_unit,
            number::fixed(*share, 2)
        );
        canvas.group(&Group { class: "mark", title: Some(&title), ..Group::default() }, |layer| {
            layer.mark(Mark::Circle, point, 2.4, BLUE);
        });
    }
    frame.spine(&mut canvas);
    canvas.finish()
}
