//! One statistic over all selections: its order statistics, and the selections that do not meet its
//! limit.

use super::{
    case::{Case, Measure, Quantity},
    extremes,
    fails::Fails,
    halves::{Halves, Parts},
    listed::Listed,
    pooled::{Ends, Pooled},
    spread::{Limit, order},
};

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
) -> OverAll {
    let mut without = |row: u32, column: u32| {
        let none = || Fails::new(halves.rows.count, halves.columns.count);
        undefined.get_or_insert_with(none).fail(row, column);
    };
    match measure.parts(halves) {
        Parts::Pooled => {
            let found = Pooled::over(measure, halves);
            let failing = found.mark(measure, fails, without);
            with_worst(measure, found.listed(1.0), found.ends(), failing)
        }
        Parts::Sums { blocks, form, undefined: nowhere } => {
            for (rows, columns) in nowhere {
                rows.iter()
                    .for_each(|&row| columns.iter().for_each(|&column| without(row, column)));
            }
            let (low, high) = form.bounds(measure.low, measure.high);
            let mut limit = Limit { low, high, fails, count: 0 };
            let found = order(&blocks, form, Some(&mut limit));
            let failing = limit.count;
            let ends = found.as_ref().map(|order| (order.at_min, order.at_max));
            with_worst(measure, found.map(|order| order.listed), ends, failing)
        }
        Parts::Extremes { rows, columns, negative } => {
            let sign = if negative { -1.0 } else { 1.0 };
            let mut failing = 0;
            // The larger of two exceeds an upper bound if either does, and is below a lower bound
            // if both are.
            for (row, r) in rows.iter().enumerate() {
                for (column, c) in columns.iter().enumerate() {
                    match (*r).into_iter().chain(*c).reduce(f64::max) {
                        None => without(row as u32, column as u32),
                        Some(value) if !measure.holds(sign * value) => {
                            fails.fail(row as u32, column as u32);
                            failing += 1;
                        }
                        Some(_) => {}
                    }
                }
            }
            let listed = extremes::over_all(case, measure);
            with_worst(measure, listed, extreme_ends(&rows, &columns, negative), failing)
        }
    }
}

fn with_worst(measure: &Measure, listed: Option<Listed>, ends: Ends, failing: u64) -> OverAll {
    let worst = listed.zip(ends).map(|(listed, (at_min, at_max))| {
        if measure.low_is_worse(listed.min, listed.max) {
            (at_min, listed.min)
        } else {
            (at_max, listed.max)
        }
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
    let in_all: Vec<usize> = quantity.values.iter().map(Vec::len).collect();
    let groups = quantity.minimum_of_groups.iter().map(|group| (group.needed, &group.pairs));
    for (needed, pairs) in groups.chain([(quantity.minimum_pairs, &in_all)]) {
        let sum = |choice: &[u32]| choice.iter().map(|&at| pairs[at as usize]).sum::<usize>();
        let all = [&halves.rows, &halves.columns].map(|half| half.choices().map(sum).collect());
        let least = all.each_ref().map(|sums: &Vec<usize>| sums.iter().min().copied());
        if least.into_iter().flatten().sum::<usize>() < needed {
            mark(halves, &all, |row, column| row + column < needed, undefined);
        }
    }
    let signals = |choice: &[u32]| {
        choice.iter().fold(0_u128, |signals, &at| signals | quantity.signals[at as usize])
    };
    let all = [&halves.rows, &halves.columns].map(|half| half.choices().map(signals).collect());
    let common = all.each_ref().map(|signals: &Vec<u128>| signals.iter().fold(!0, |a, b| a & b));
    let few =
        |one: &u128, other: &u128| ((one | other).count_ones() as usize) < quantity.minimum_signals;
    if few(&common[0], &common[1]) {
        mark(halves, &all, few, undefined);
    }
}

/// Marks the selections whose row and column together have too little of something.
fn mark<T>(
    halves: &Halves,
    [rows, columns]: &[Vec<T>; 2],
    lacks: impl Fn(&T, &T) -> bool,
    undefined: &mut Option<Fails>,
) {
    let none = || Fails::new(halves.rows.count, halves.columns.count);
    let undefined = undefined.get_or_insert_with(none);
    for (row, of_row) in rows.iter().enumerate() {
        for (column, of_column) in columns.iter().enumerate() {
            if lacks(of_row, of_column) {
                undefined.fail(row as u32, column as u32);
            }
        }
    }
}
