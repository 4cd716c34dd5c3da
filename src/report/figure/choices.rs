//! Influence of parameters on the verdict: the largest normalised statistic for every value of
//! every parameter.

use super::kit::*;
use crate::result::{
    Verdict, VerdictWords,
    study::{AtValue, Largest, ParameterStudy},
};

/// Heights of a row and of the line between parameters, in points.
const ROW: f64 = 10.0;
const GAP: f64 = 16.0;
const NAMES: f64 = 118.0;
const SHARES: f64 = 62.0;

fn sign(verdict: Verdict) -> (Mark, Color) {
    match verdict {
        Verdict::Validated => (Mark::Circle, BLUE),
        Verdict::NotValidated => (Mark::Triangle, VERMILION),
        Verdict::NotAssessable => (Mark::Bar, MUTED),
    }
}

/// One row per value: the limit at 1, shape and colour for the verdict, the share of selections for
/// which the verdict holds at the right.
pub fn choices(study: &ParameterStudy, words: &VerdictWords) -> String {
    let legend = Legend::new(
        [Verdict::Validated, Verdict::NotValidated, Verdict::NotAssessable]
            .map(|verdict| Entry::mark(sign(verdict), words.word(verdict))),
        WIDTH - NAMES,
    );
    let rows: usize = study.parameters.iter().map(|parameter| parameter.values.len()).sum();
    let top = legend.height() + 14.0;
    let height = rows as f64 * ROW + study.parameters.len() as f64 * GAP;
    let largest = |at: &AtValue| at.largest.as_ref().map(|largest| largest.normalised);
    let all =
        study.parameters.iter().flat_map(|parameter| parameter.values.iter().filter_map(largest));
    let high = all.clone().fold(1.1, f64::max).min(4.0);
    let low = all.fold(0.9, f64::min).max(0.0);
    let room = 0.05 * (high - low);
    let range = ((low - room).max(0.0), high + room);
    let frame = Frame::rows(range, (NAMES, WIDTH - SHARES), (top, top + height));
    let limit = frame.x.at(1.0);
    let mut canvas = Canvas::new(WIDTH, top + height + 28.0);
    legend.draw(&mut canvas, (NAMES, 0.0));
    frame.beyond_right(&mut canvas);
    canvas.text(&words.good, (WIDTH - 2.0, top - 6.0), &Font::right(SMALL).color(MUTED));
    frame.x_axis(&mut canvas, 8, "largest statistic / limit, all sections");
    let (mut y, mut limit_ends) = (top, vec![top]);
    for parameter in &study.parameters {
        let title = cut(&parameter.title, TEXT, WIDTH - SHARES - 8.0);
        // No grid behind the title, and no limit; the ground beyond the limit stays whole.
        let end = 6.0 + text_width(&title, TEXT);
        canvas.rect((0.0, y + 3.0), (end.min(limit).max(0.0), y + 13.0), WHITE);
        if end > limit - 1.0 {
            let corner = (end.clamp(limit, frame.right()), y + 13.0);
            canvas.rect((limit, y + 3.0), corner, BEYOND);
            limit_ends.extend([y + 2.0, y + 14.0]);
        }
        canvas.text(&title, (2.0, y + 8.0), &Font::left(TEXT).bold(parameter.decides));
        y += GAP;
        for at in &parameter.values {
            row(&mut canvas, &frame, (at, words.word(at.verdict)), y + 0.5 * ROW - 2.0);
            y += ROW;
        }
    }
    limit_ends.push(frame.bottom());
    let pieces = limit_ends.chunks_exact(2).map(|ends| ((limit, ends[0]), (limit, ends[1])));
    canvas.lines("limit", LIMIT, pieces);
    canvas.line((frame.left(), frame.bottom()), (frame.right(), frame.bottom()), INK, 0.7);
    canvas.finish()
}

fn row(canvas: &mut Canvas, frame: &Frame, (at, verdict): (&AtValue, &str), y: f64) {
    let share = at.share.map_or_else(
        || number::NONE.to_owned(),
        |share| format!("{} %", number::fixed(100.0 * share, 2)),
    );
    canvas.line((frame.left(), y), (frame.right(), y), GRID, 0.4);
    let value = cut(&at.value, SMALL, NAMES - 16.0);
    canvas.text(&value, (NAMES - 5.0, y), &Font::right(SMALL).bold(at.is_base));
    canvas.text(&share, (WIDTH - 2.0, y), &Font::right(SMALL));
    if let Some(Largest { statistic: which, normalised: value }) = &at.largest {
        let title =
            format!("{}: {which} {} of its limit, {}", at.value, number::fixed(*value, 3), verdict);
        canvas.group(&Group::mark(&title), |canvas| {
            canvas.mark(sign(at.verdict), (frame.x.within(*value), y), 2.2);
        });
    }
}
