//! The values of one quantity: simulated over measured, and the differences by section.

use super::{
    differences,
    kit::*,
    levels::Levels,
    pair_mark::Pairs,
    zones::{Marks, Zones},
};
use crate::report::sides::Sides;
use crate::result::{PairValue, QuantityResult};

/// Height of the plotting areas, in points; the left one is square.
const HEIGHT: f64 = 158.0;
/// Minimum width of y axes with numbers and title, in points, so that figures align.
const AXIS: f64 = 38.0;
/// Distance between the two diagrams, in points.
const GUTTER: f64 = 12.0;
/// Maximum number of ticks of the left diagram.
const TICKS: usize = 5;

/// Left, simulated over measured values; right, differences in the order of the sections with mean,
/// standard deviation and limits. If a metric gives one number for both signals, only the right
/// diagram over the full width.
pub fn pairs(quantity: &QuantityResult, zones: &Zones) -> String {
    let levels = Levels::of(quantity);
    let looks = Marks::of(quantity.values.iter(), zones);
    let marks = Legend::new(looks.legend(quantity.values.iter()), WIDTH - AXIS);
    let lines = Legend::new(levels.legend.clone(), WIDTH - AXIS);
    let top = marks.height() + lines.height() + 16.0;
    let bottom = top + HEIGHT;
    let with_sides: Vec<(&PairValue, f64, f64)> = quantity
        .values
        .iter()
        .filter_map(|pair| Some((pair, pair.simulated?, pair.measured?)))
        .collect();
    let both = quantity.has_sides && !with_sides.is_empty();
    let own = axis::room(differences::range(quantity, &levels), differences::TICKS).max(AXIS);
    let side = axis::room(axis::over(ends(&with_sides)), TICKS).max(AXIS);
    let left = if both { side + HEIGHT + GUTTER + own } else { own };
    let slots = differences::Slots::of(quantity);
    let mut canvas = Canvas::new(WIDTH, bottom + slots.room().max(24.0));
    marks.draw(&mut canvas, (AXIS, 0.0));
    lines.draw(&mut canvas, (AXIS, marks.height()));
    if both {
        scatter(&mut canvas, quantity, &looks, &with_sides, (side, bottom));
    }
    let against = differences::Against { marks: &looks, levels: &levels, slots: &slots };
    differences::draw(&mut canvas, quantity, &against, (left, top, bottom));
    canvas.finish()
}

/// Simulated and measured values of all pairs, for the common range of both axes.
fn ends(values: &[(&PairValue, f64, f64)]) -> impl Iterator<Item = f64> {
    values.iter().flat_map(|(_, simulated, measured)| [*simulated, *measured])
}

fn scatter(
    canvas: &mut Canvas,
    quantity: &QuantityResult,
    marks: &Marks<'_>,
    values: &[(&PairValue, f64, f64)],
    (left, bottom): (f64, f64),
) {
    let Sides { one, other, .. } = Sides::of(quantity);
    let range = axis::over(ends(values));
    let frame = Frame::new(range, range, (left, left + HEIGHT), (bottom - HEIGHT, bottom));
    frame.x_axis(canvas, TICKS, &axis::title(&other, &quantity.unit));
    frame.y_axis(canvas, TICKS, &axis::title(one, &quantity.unit));
    canvas.line((frame.left(), bottom), (frame.right(), frame.top()), MUTED, 0.8);
    canvas.text(
        &format!("{one} = {other}"),
        (frame.right(), frame.top() - 5.0),
        &Font::right(TICK).color(MUTED),
    );
    frame.spine(canvas);
    let pairs = Pairs::with_decimals_of(quantity, ends(values));
    for (pair, simulated, measured) in values {
        pairs.draw(canvas, pair, marks.mark(pair), frame.at(*measured, *simulated), 2.1);
    }
}
