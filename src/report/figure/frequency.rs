//! Cumulative frequency of the values of a quantity: one curve for each record, or for each zone
//! where there is one record.

use indexmap::IndexMap;

use super::{kit::*, pair_mark::Pairs, style, zones::Zones};
use crate::result::{PairValue, QuantityResult, StatisticName, StatisticResult};

const HEIGHT: f64 = 140.0;
/// Most limits that are drawn one by one; of more, the smallest and the largest.
const LIMITS: usize = 6;

/// Fewest values that are drawn: a curve of fewer says no more than the table of values.
const FEWEST: usize = 5;

/// Whether it is drawn: of an assessed quantity, and of a metric with a limit of the distribution
/// of its values.
pub fn has_frequency(quantity: &QuantityResult) -> bool {
    let of_distribution = || {
        quantity
            .statistics
            .iter()
            .any(|one| one.divided_at.is_some() || matches!(one.name, StatisticName::Percentile(_)))
    };
    quantity.values.len() >= FEWEST
        && (quantity.from.is_some() || !quantity.has_sides && of_distribution())
}

/// Values in increasing order, each at the share of values of its curve that do not exceed it.
pub fn frequency(quantity: &QuantityResult, zones: &Zones) -> String {
    let several = quantity.values.iter().any(|value| value.record.is_some());
    let mut curves: IndexMap<String, Vec<&PairValue>> = IndexMap::new();
    for value in &quantity.values {
        let record = value.record.as_ref().map(ToString::to_string);
        let of = if several { record } else { value.zone.clone() };
        curves.entry(of.unwrap_or_default()).or_default().push(value);
    }
    let look =
        |at: usize, name: &str| if several { style::look(at) } else { zones.mark(Some(name)) };
    let mut entries = Vec::new();
    for (at, (name, values)) in curves.iter_mut().enumerate() {
        values.sort_by(|a, b| a.difference.total_cmp(&b.difference));
        let of = match (several, name.is_empty()) {
            (_, true) => "values".to_owned(),
            (true, _) => name.clone(),
            (false, _) => format!("zone {name}"),
        };
        let count = number::count(values.len() as u64);
        entries.push(Entry::mark(look(at, name), format!("{of} ({count})")));
    }
    let limits = limits(quantity);
    if let [first, .., last] = limits.as_slice() {
        entries.push(Entry::line(LIMIT, format!("limits {} to {}", first.1, last.1)));
    } else if let [(_, one)] = limits.as_slice() {
        entries.push(Entry::line(LIMIT, format!("limit {one}")));
    }
    let legend = Legend::new(entries, WIDTH - 40.0);
    let (y, ticks, top) = ((0.0, 100.0), 5, legend.height() + 10.0);
    let at_limits = || limits.iter().map(|(limit, _)| *limit);
    let along = axis::over(quantity.values.iter().map(|value| value.difference).chain(at_limits()));
    let frame = Frame::new(along, y, (axis::room(y, ticks), WIDTH - 6.0), (top, top + HEIGHT));
    let mut canvas = Canvas::new(WIDTH, frame.bottom() + 25.0);
    legend.draw(&mut canvas, (frame.left(), 0.0));
    frame.x_axis(&mut canvas, 8, &axis::title("value", &quantity.unit));
    frame.y_axis(&mut canvas, ticks, "values not above [%]");
    frame.upright_limits(&mut canvas, at_limits());
    if let Some((limit, _)) = limits.last() {
        let font = Font::middle(TICK).color(MUTED);
        canvas.text("limit", (frame.x.at(*limit), top - 5.0), &font);
    }
    let pairs = Pairs::new(quantity);
    for (at, (name, values)) in curves.iter().enumerate() {
        curve(&mut canvas, &frame, values, look(at, name), &pairs);
    }
    frame.spine(&mut canvas);
    canvas.finish()
}

/// Steps from each value to the next, and a mark at each value.
fn curve(
    canvas: &mut Canvas,
    frame: &Frame,
    values: &[&PairValue],
    look: (Mark, Color),
    pairs: &Pairs<'_>,
) {
    let at = |value: &PairValue, rank: usize| {
        frame.at(value.difference, 100.0 * rank as f64 / values.len() as f64)
    };
    let finite = values.iter().enumerate().filter(|(_, value)| value.difference.is_finite());
    let steps: Vec<(f64, f64)> =
        finite.flat_map(|(rank, value)| [at(value, rank), at(value, rank + 1)]).collect();
    canvas.curve("curve", Pen::solid(look.1, 0.8), &steps);
    for (rank, value) in values.iter().enumerate() {
        pairs.draw(canvas, value, look, at(value, rank + 1), 1.7);
    }
}

/// The different limits of the quantity in its unit, in increasing order, with their texts; of a
/// magnitude on both sides where values are.
fn limits(quantity: &QuantityResult) -> Vec<(f64, String)> {
    // The limit of a share is no value; where the share divides the values is one.
    let of =
        |one: &StatisticResult| one.divided_at.or(one.limit.filter(|_| one.unit == quantity.unit));
    let stated = quantity.statistics.iter().filter_map(of);
    let mut all: Vec<f64> = stated.collect();
    if quantity.values.iter().any(|value| value.difference < 0.0) {
        all.extend(all.clone().into_iter().map(|limit| -limit));
    }
    all.sort_by(f64::total_cmp);
    let decimals = number::decimals(&quantity.unit, all.iter().copied());
    let mut named: Vec<(f64, String)> =
        all.into_iter().map(|limit| (limit, number::fixed(limit, decimals))).collect();
    named.dedup_by(|a, b| a.1 == b.1);
    if named.len() > LIMITS {
        named.drain(1..named.len() - 1);
    }
    named
}
