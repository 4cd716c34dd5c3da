//! One statistic over all selections: its order statistics, and the selections that do not meet its
//! limit.

use super::case::{Case, Measure, Quantity};
use super::extremes;
use super::fails::Fails;
use super::halves::{Half, Halves, Parts};
use super::listed::Listed;
use super::pooled::{Ends, Pooled};
use super::spread::{Limit, Memory, order};

/// A statistic over all selections.
#[derive(Clone, Debug)]
pub struct OverAll {
    pub spread: Option<Listed>,
    pub failing: u64,
    /// Row and column of the worst value against the limit, and that value.
    pub worst: Option<((u32, u32), f64)>,
}

/// Computes the order statistics, and marks the selections that do not meet the limit or have no
/// value.
pub fn over_all(
    case: &Case,
    measure: &Measure,
    halves: &Halves,
    fails: &mut Fails,
    undefined: &mut Option<Fails>,
    memory: &mut Memory,
) -> OverAll {
    let parts = measure.parts(halves);
    if matches!(parts, Parts::Pooled) {
        let found = Pooled::over(measure, halves);
        let failing = found.mark(measure, halves, fails, undefined);
        return with_worst(measure, found.listed(1.0), found.ends(), failing);
    }
    let mut without = |row: u32, column: u32| {
        undefined
            .get_or_insert_with(|| Fails::new(halves.rows.count, halves.columns.count))
            .one(row, column);
    };
    let mut failing = 0;
    let (listed, ends) = match parts {
        Parts::Sums { blocks, form, undefined: nowhere } => {
            for (rows, columns) in nowhere {
                rows.iter()
                    .for_each(|&row| columns.iter().for_each(|&column| without(row, column)));
            }
            let (low, high) = form.bounds(measure.low, measure.high);
            let mut limit = Limit { low, high, fails, count: 0 };
            let found = order(&blocks, form, Some(&mut limit), memory);
            failing = limit.count;
            let ends = found.as_ref().map(|order| (order.at_min, order.at_max));
            (found.map(Listed::from), ends)
        }
        Parts::Extremes { rows, columns, negative } => {
            let sign = if negative { -1.0 } else { 1.0 };
            let within =
                |value: &Option<f64>| value.is_none_or(|value| measure.holds(sign * value));
            // The larger of two exceeds an upper bound if either does, and is below a lower bound
            // if both are.
            for (row, r) in rows.iter().enumerate() {
                for (column, c) in columns.iter().enumerate() {
                    match (*r).into_iter().chain(*c).reduce(f64::max) {
                        None => without(row as u32, column as u32),
                        Some(value) if !within(&Some(value)) => {
                            fails.one(row as u32, column as u32);
                            failing += 1;
                        }
                        Some(_) => {}
                    }
                }
            }
            (extremes::over_all(case, measure), extreme_ends(&rows, &columns, negative))
        }
        Parts::Pooled => (None, None),
    };
    with_worst(measure, listed, ends, failing)
}

fn with_worst(measure: &Measure, listed: Option<Listed>, ends: Ends, failing: u64) -> OverAll {
    let worst = listed.zip(ends).map(|(listed, (at_min, at_max))| {
        let low = if measure.at_least { true } else { -listed.min > listed.max };
        if low { (at_min, listed.min) } else { (at_max, listed.max) }
    });
    OverAll { spread: listed, failing, worst }
}

/// Positions of the minimum and the maximum of the larger of two.
fn extreme_ends(rows: &[Option<f64>], columns: &[Option<f64>], negative: bool) -> Ends {
    let by = |value: &Option<f64>| value.unwrap_or(f64::NEG_INFINITY);
    let least = |values: &[Option<f64>]| {
        (0..values.len()).min_by(|a, b| by(&values[*a]).total_cmp(&by(&values[*b])))
    };
    let most = |values: &[Option<f64>]| {
        (0..values.len()).rev().max_by(|a, b| by(&values[*a]).total_cmp(&by(&values[*b])))
    };
    let at_least = (least(rows)? as u32, least(columns)? as u32);
    let at_most = (most(rows)? as u32, most(columns)? as u32);
    Some(if negative { (at_most, at_least) } else { (at_least, at_most) })
}

/// Marks selections with fewer signals or pairs than the protocol requires.
pub fn too_few(quantity: &Quantity, halves: &Halves, undefined: &mut Option<Fails>) {
    for group in &quantity.minimum_of_groups {
        let of = |half: &Half| -> Vec<usize> {
            half.choices()
                .map(|choice| choice.iter().map(|&at| group.pairs[at as usize]).sum())
                .collect()
        };
        let (rows, columns) = (of(&halves.rows), of(&halves.columns));
        let least = |all: &[usize]| all.iter().min().copied().unwrap_or(0);
        if least(&rows) + least(&columns) >= group.needed {
            continue;
        }
        let fails =
            undefined.get_or_insert_with(|| Fails::new(halves.rows.count, halves.columns.count));
        for (row, pairs) in rows.iter().enumerate() {
            for (column, _) in
                columns.iter().enumerate().filter(|(_, more)| pairs + **more < group.needed)
            {
                fails.one(row as u32, column as u32);
            }
        }
    }
    let of = |half: &Half| -> Vec<(usize, u128)> {
        half.choices()
            .map(|choice| {
                choice.iter().fold((0, 0), |(pairs, signals), &at| {
                    (
                        pairs + quantity.values[at as usize].len(),
                        signals | quantity.signals[at as usize],
                    )
                })
            })
            .collect()
    };
    let (rows, columns) = (of(&halves.rows), of(&halves.columns));
    let least = |all: &[(usize, u128)]| all.iter().map(|(pairs, _)| *pairs).min().unwrap_or(0);
    let common =
        |all: &[(usize, u128)]| all.iter().fold(u128::MAX, |common, (_, signals)| common & signals);
    let enough = least(&rows) + least(&columns) >= quantity.minimum_pairs
        && (common(&rows) | common(&columns)).count_ones() as usize >= quantity.minimum_signals;
    if enough {
        return;
    }
    let fails =
        undefined.get_or_insert_with(|| Fails::new(halves.rows.count, halves.columns.count));
    for (row, (pairs, signals)) in rows.iter().enumerate() {
        for (column, (more, others)) in columns.iter().enumerate() {
            if pairs + more < quantity.minimum_pairs
                || ((signals | others).count_ones() as usize) < quantity.minimum_signals
            {
                fails.one(row as u32, column as u32);
            }
        }
    }
}
