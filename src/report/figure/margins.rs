//! The range of each change within which a verdict stays.

use super::kit::*;
use crate::result::{
    VerdictWords,
    margin::{Changed, Margin, MarginStudy},
};

/// Height of a row, and widths of the names on the left and of the numbers on the right, in points.
const ROW: f64 = 12.0;
const NAMES: f64 = 140.0;
const NUMBERS: f64 = 120.0;

/// Largest change of a limit that is drawn, in per cent.
const MOST: f64 = 100.0;

/// The name of a change, and from where to where the verdict stays.
type Label<'a> = &'a dyn Fn(&Margin) -> [String; 2];

/// A bar for each change that has two sides, as a share of the largest one that was searched.
pub fn margins(study: &MarginStudy, words: &VerdictWords, label: Label<'_>) -> String {
    let rows: Vec<&Margin> = study.margin.iter().filter(|margin| drawn(margin)).collect();
    let legend = Legend::new(
        [
            Entry::line(Pen::solid(BLUE, 4.0), format!("verdict '{}'", words.word(study.verdict))),
            Entry::mark((Mark::Triangle, VERMILION), "it flips"),
        ],
        WIDTH - NAMES,
    );
    let top = legend.height() + 10.0;
    let edges = (NAMES, WIDTH - NUMBERS);
    let frame = Frame::rows((-1.05, 1.05), edges, (top, top + rows.len() as f64 * ROW));
    let mut canvas = Canvas::new(WIDTH, frame.bottom() + 8.0);
    legend.draw(&mut canvas, (NAMES, 0.0));
    for (at, margin) in rows.iter().enumerate() {
        let y = top + (at as f64 + 0.5) * ROW;
        row(&mut canvas, &frame, (margin, scale(margin, &rows)), &label(margin), y);
    }
    let none = frame.x.at(0.0);
    canvas.line((none, frame.top()), (none, frame.bottom()), INK, 0.7);
    canvas.finish()
}

fn drawn(margin: &Margin) -> bool {
    match margin.change {
        Changed::Gain | Changed::Offset | Changed::Shift => true,
        Changed::Limit => margin.flips(),
        Changed::Parameter | Changed::Sections => false,
    }
}

/// How far the farthest change is that is drawn to the same scale.
fn scale(margin: &Margin, rows: &[&Margin]) -> f64 {
    let ends = |one: &Margin| {
        let searched = one.searched.map_or([0.0; 2], |of| [of.from, of.to]);
        let ends = [one.low.unwrap_or(0.0), one.high.unwrap_or(0.0)];
        searched.into_iter().chain(ends).map(f64::abs).fold(0.0, f64::max)
    };
    let alike = rows.iter().filter(|one| one.change == margin.change);
    let far = match margin.change {
        Changed::Gain | Changed::Limit => alike.map(|one| ends(one)).fold(0.0, f64::max),
        _ => ends(margin),
    };
    let far = if margin.change == Changed::Limit { far.min(MOST) } else { far };
    if far > 0.0 { far } else { 1.0 }
}

fn row(
    canvas: &mut Canvas,
    frame: &Frame,
    (margin, scale): (&Margin, f64),
    [title, shown]: &[String; 2],
    y: f64,
) {
    canvas.text(&cut(title, TEXT, NAMES - 8.0), (2.0, y), &Font::left(TEXT));
    let numbers = cut(shown, SMALL, NUMBERS - 8.0);
    canvas.text(&numbers, (WIDTH - 2.0, y), &Font::right(SMALL));
    canvas.line((frame.left(), y), (frame.right(), y), GRID, 0.4);
    let x = |value: f64| frame.x.within((value / scale).clamp(-1.0, 1.0));
    let (from, to) = margin.searched.map_or((-scale, scale), |of| (of.from, of.to));
    let (low, high) = (margin.low.unwrap_or(from), margin.high.unwrap_or(to));
    canvas.group(&Group::mark(&format!("{title}: {shown}")), |canvas| {
        canvas.line((x(low), y), (x(high), y), BLUE, 4.0);
        for end in [margin.low, margin.high].into_iter().flatten() {
            canvas.mark((Mark::Triangle, VERMILION), (x(end), y), 2.6);
        }
    });
}
