//! Cumulative frequency of the values of a quantity: one curve for each record, or for each zone
//! where there is one record.

use indexmap::IndexMap;
use plotters::style::RGBColor;

use super::axis::{self, Scale};
use super::canvas::{Canvas, Font, Group};
use super::frame::Frame;
use super::legend::{Entry, Legend};
use super::pair_mark::{pair_group, tooltip};
use super::style::{self, DASHED, INK, MUTED, Mark, TICK, WIDTH};
use super::zones::Zones;
use crate::report::number;
use crate::result::{PairValue, QuantityResult, StatisticResult};

const HEIGHT: f64 = 140.0;
/// Most limits that are drawn one by one; of more, the smallest and the largest.
const LIMITS: usize = 6;

/// Fewest values that are drawn: a curve of fewer says no more than the table of values.
const FEWEST: usize = 5;

/// Whether it is drawn: of an assessed quantity, and of a metric with a limit of the distribution
/// of its values.
pub fn has_frequency(quantity: &QuantityResult) -> bool {
    let percentile =
        |name: &str| name.strip_prefix('p').is_some_and(|percent| percent.parse::<f64>().is_ok());
    let of_distribution =
        || quantity.statistics.iter().any(|one| one.divided_at.is_some() || percentile(&one.name));
    quantity.values.len() >= FEWEST
        && (quantity.from.is_some() || !quantity.has_sides && of_distribution())
}

/// Values in increasing order, each at the share of values of its curve that do not exceed it.
pub fn frequency(quantity: &QuantityResult, zones: &Zones) -> String {
    let several = quantity.values.iter().any(|value| value.record.is_some());
    let mut curves: IndexMap<&str, Vec<&PairValue>> = IndexMap::new();
    for value in &quantity.values {
        let of = if several { &value.record } else { &value.zone };
        curves.entry(of.as_deref().unwrap_or_default()).or_default().push(value);
    }
    let look = |at: usize, name: &str| {
        if several { (Mark::nth(at), style::color(at)) } else { zones.mark(Some(name)) }
    };
    let mut entries = Vec::new();
    for (at, (name, values)) in curves.iter_mut().enumerate() {
        values.sort_by(|a, b| a.difference.total_cmp(&b.difference));
        let (mark, color) = look(at, name);
        let of = match (several, name.is_empty()) {
            (_, true) => "values".to_owned(),
            (true, _) => (*name).to_owned(),
            (false, _) => format!("zone {name}"),
        };
        entries.push(Entry::mark(
            mark,
            color,
            format!("{of} ({})", number::count(values.len() as u64)),
        ));
    }
    let limits = limits(quantity);
    if let [first, .., last] = limits.as_slice() {
        entries.push(Entry::line(INK, 0.9, DASHED, format!("limits {} to {}", first.1, last.1)));
    } else if let [(_, one)] = limits.as_slice() {
        entries.push(Entry::line(INK, 0.9, DASHED, format!("limit {one}")));
    }
    let legend = Legend::new(entries, WIDTH - 40.0);
    let top = legend.height() + 10.0;
    let bottom = top + HEIGHT;
    let y = Scale { low: 0.0, high: 100.0, from: bottom, to: top };
    let ticks = y.ticks(5);
    let left = Frame::axis_room(&ticks);
    let along = quantity
        .values
        .iter()
        .map(|value| value.difference)
        .chain(limits.iter().map(|(limit, _)| *limit));
    let frame = Frame { x: Scale::over(along, left, WIDTH - 6.0), y };
    let mut canvas = Canvas::new(WIDTH, bottom + 25.0);
    legend.draw(&mut canvas, (left, 0.0));
    frame.x_axis(&mut canvas, &frame.x.ticks(8), &axis::title("value", &quantity.unit));
    frame.y_axis(&mut canvas, &ticks, "values not above [%]");
    canvas.group(&Group { class: "limit", dash: DASHED, ..Group::default() }, |layer| {
        for (limit, _) in &limits {
            layer.line((frame.x.at(*limit), top), (frame.x.at(*limit), bottom), INK, 0.9);
        }
    });
    canvas.draw(|layer| {
        if let Some((limit, _)) = limits.last() {
            layer.text("limit", (frame.x.at(*limit), top - 5.0), &Font::middle(TICK).color(MUTED));
        }
    });
    let decimals =
        number::decimals(&quantity.unit, quantity.values.iter().map(|value| value.difference));
    for (at, (name, values)) in curves.iter().enumerate() {
        curve(&mut canvas, &frame, values, look(at, name), (quantity, decimals));
    }
    frame.spine(&mut canvas);
    canvas.finish()
}

/// Steps from each value to the next, and a mark at each value.
fn curve(
    canvas: &mut Canvas,
    frame: &Frame,
    values: &[&PairValue],
    (mark, color): (Mark, RGBColor),
    (quantity, decimals): (&QuantityResult, usize),
) {
    let share = |rank: usize| 100.0 * rank as f64 / values.len() as f64;
    let finite = values.iter().enumerate().filter(|(_, value)| value.difference.is_finite());
    let steps: Vec<(f64, f64)> = finite
        .flat_map(|(rank, value)| {
            let x = frame.x.at(value.difference);
            [(x, frame.y.at(share(rank))), (x, frame.y.at(share(rank + 1)))]
        })
        .collect();
    canvas.group(&Group { class: "curve", ..Group::default() }, |layer| {
        layer.path(&steps, color, 0.8)
    });
    for (rank, value) in values.iter().enumerate() {
        let title = tooltip(value, quantity, decimals);
        canvas.group(&pair_group(value, &title), |layer| {
            layer.mark(
                mark,
                (frame.x.at(value.difference), frame.y.at(share(rank + 1))),
                1.7,
                color,
            );
        });
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
