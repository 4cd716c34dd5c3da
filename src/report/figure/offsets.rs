//! Study of offsets: normalised statistics of one selection (as Götz and Polach, Figure 7) and the
//! share validated.

use super::{kit::*, ratios::Ratios};
use crate::result::{
    StatisticName, VerdictWords,
    study::{AtOffset, SyncStudy},
};

const PANEL: f64 = 118.0;
const LABELS: f64 = 26.0;

/// Statistics of one selection: one mark per offset; one panel for means, one for all other
/// statistics.
pub fn selection(study: &SyncStudy) -> String {
    let entries =
        study.offsets.iter().enumerate().map(|(n, at)| Entry::mark(look(n), name(study, at)));
    let legend = Legend::new(entries, WIDTH - 40.0);
    let top = legend.height() + 8.0;
    let of = |mean: bool| -> Vec<(usize, String)> {
        let Some(first) = study.offsets.iter().find(|at| !at.selected.is_empty()) else {
            return Vec::new();
        };
        let wanted = first
            .selected
            .iter()
            .enumerate()
            .filter(|(_, one)| (one.name == StatisticName::Mean) == mean);
        wanted
            .map(|(at, one)| {
                let word = match &one.name {
                    StatisticName::Mean | StatisticName::StandardDeviation => String::new(),
                    other => format!(" {other}"),
                };
                (at, format!("{}{word}{}", one.symbol, one.scope.suffix()))
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
    number::with_unit(&number::significant(at.offset.value(), 4), &study.axis_unit)
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
    let range = (low, high + 0.03 * (high - low));
    let edges = (top, top + PANEL);
    let ratios = Ratios::new(canvas, (range, signed), statistics.len(), edges, title);
    let frame = &ratios.frame;
    let count = study.offsets.len().max(1) as f64;
    for (place, (statistic, label)) in statistics.iter().enumerate() {
        for (n, at) in study.offsets.iter().enumerate() {
            let Some(value) = value(at, *statistic) else { continue };
            let x = frame.x.at(place as f64 + 0.12 + 0.76 * (n as f64 + 0.5) / count);
            let shown = format!("{label}, {}: {}", name(study, at), number::fixed(value, 3));
            canvas.group(&Group::mark(&shown), |canvas| {
                canvas.mark(look(n), (x, frame.y.within(value)), 1.6);
            });
        }
        ratios.label(canvas, place, label);
    }
    ratios.limits(canvas);
    frame.spine(canvas);
}

/// The share of selections for which the verdict holds as a function of the offset.
pub fn shares(study: &SyncStudy, words: &VerdictWords) -> String {
    let found = study
        .offsets
        .iter()
        .filter_map(|at| Some((at.offset.value(), at.selections.counted().ok()?)));
    let points: Vec<(f64, f64)> =
        found.map(|(offset, found)| (offset, 100.0 * found.share.share)).collect();
    let (y, ticks) = ((0.0, 103.0), 6);
    let x = axis::over(study.offsets.iter().map(|at| at.offset.value()));
    let frame = Frame::new(x, y, (axis::room(y, ticks), WIDTH - 10.0), (8.0, 128.0));
    let mut canvas = Canvas::new(WIDTH, 158.0);
    frame.y_axis(&mut canvas, ticks, &format!("selections {} [%]", words.good));
    let unit = number::unit(&study.axis_unit);
    frame.x_axis(&mut canvas, 10, &format!("offset of the measurement [{unit}]"));
    let placed: Vec<(f64, f64)> =
        points.iter().map(|(offset, share)| frame.at(*offset, *share)).collect();
    canvas.path(&placed, BLUE, 0.9);
    for ((offset, share), point) in points.iter().zip(placed) {
        let title = format!(
            "{} {}: {} %",
            number::significant(*offset, 4),
            study.axis_unit,
            number::fixed(*share, 2)
        );
        canvas.group(&Group::mark(&title), |canvas| {
            canvas.mark((Mark::Circle, BLUE), point, 2.4);
        });
    }
    frame.spine(&mut canvas);
    canvas.finish()
}
