//! All selections, from sums of halves.

use std::sync::Mutex;

use rayon::prelude::*;

use super::case::{Case, Measure, Quantity};
use super::fails::Fails;
use super::halves::{Half, Halves, Parts};
use super::listed::{Listed, larger, weighted};
use super::spread::{Limit, order};
use crate::result::study::{Importance, QuantitySpread, Share, Spread, StatisticSpread, WorstSelection};
use crate::run::pool::Rule;

/// What looking at selections came to.
#[derive(Debug)]
pub struct Counted {
    pub share: Share,
    pub quantities: Vec<QuantitySpread>,
    pub sections: Vec<Importance>,
    pub worst: Vec<WorstSelection>,
    pub methods: Vec<String>,
}

/// Bits of single quantities are kept up to this many bytes in all.
const MOST_KEPT: usize = 80 << 20;

/// A statistic over all selections.
#[derive(Clone, Debug)]
pub struct OverAll {
    pub spread: Option<Listed>,
    pub failing: u64,
    /// Row and column of the value that is worst against the limit, and that value.
    pub worst: Option<((u32, u32), f64)>,
}

/// Which selections fail, and why.
#[derive(Debug)]
pub struct Verdicts {
    pub any: Fails,
    twice: Fails,
    /// Limits or quantities that fail, where a verdict allows some.
    counts: Vec<u8>,
    /// Bits of each quantity, if there is room for them.
    kept: Vec<Option<Fails>>,
    failing: Vec<u64>,
}

/// Order statistics of every limit, quantity by quantity, and what is validated.
pub fn core(case: &Case, halves: &Halves) -> (Vec<Vec<OverAll>>, Verdicts) {
    let (rows, columns) = (halves.rows.count, halves.columns.count);
    let counting = case.rule != Rule::EveryLimit;
    let small = case.quantities.len() * rows * columns / 8 <= MOST_KEPT;
    let verdicts = Mutex::new(Verdicts {
        any: Fails::new(rows, columns),
        twice: Fails::new(rows, columns),
        counts: if counting { vec![0; rows * columns] } else { Vec::new() },
        kept: vec![None; case.quantities.len()],
        failing: vec![0; case.quantities.len()],
    });
    let missing = Mutex::new(Fails::new(if counting { rows } else { 0 }, columns));
    let all: Vec<Vec<OverAll>> = case
        .quantities
        .par_iter()
        .enumerate()
        .with_max_len(1)
        .map(|(at, quantity)| {
            let mut of_quantity = Fails::new(rows, columns);
            let mut undefined = None;
            let mut found = Vec::new();
            for measure in &quantity.measures {
                if matches!(case.rule, Rule::AtLeastLimits(_)) {
                    let mut fails = Fails::new(rows, columns);
                    found.push(measured(measure, halves, &mut fails, &mut undefined));
                    fails.tally(&mut verdicts.lock().expect("no panic holds the lock").counts);
                    of_quantity.join_all(&fails);
                } else {
                    found.push(measured(measure, halves, &mut of_quantity, &mut undefined));
                }
            }
            if !quantity.measures.is_empty() {
                too_few(quantity, halves, &mut undefined);
            }
            if let Some(undefined) = &undefined {
                of_quantity.join_all(undefined);
                if counting {
                    missing.lock().expect("no panic holds the lock").join_all(undefined);
                }
            }
            let mut verdicts = verdicts.lock().expect("no panic holds the lock");
            let Verdicts { any, twice, counts, kept, failing } = &mut *verdicts;
            failing[at] = of_quantity.count();
            any.join(&of_quantity, twice);
            if matches!(case.rule, Rule::AtLeastQuantities(_)) {
                of_quantity.tally(counts);
            }
            kept[at] = small.then_some(of_quantity);
            found
        })
        .collect();
    let mut verdicts = verdicts.into_inner().expect("no panic holds the lock");
    let of = |units: usize, needed: usize| units.saturating_sub(needed);
    let allowed = match case.rule {
        Rule::EveryLimit => None,
        Rule::AtLeastQuantities(needed) => {
            Some(of(case.quantities.iter().filter(|quantity| !quantity.measures.is_empty()).count(), needed))
        }
        Rule::AtLeastLimits(needed) => Some(of(case.measures().count(), needed)),
    };
    if let Some(allowed) = allowed {
        let mut any = missing.into_inner().expect("no panic holds the lock");
        for row in 0..rows {
            for column in 0..columns {
                if usize::from(verdicts.counts[row * columns + column]) > allowed {
                    any.one(row as u32, column as u32);
                }
            }
        }
        verdicts.any = any;
    }
    (all, verdicts)
}

/// One statistic: its order statistics, with the selections marked that break its limit and those where it is not defined.
fn measured(measure: &Measure, halves: &Halves, fails: &mut Fails, undefined: &mut Option<Fails>) -> OverAll {
    let parts = measure.parts(halves);
    if matches!(parts, Parts::Pooled) {
        let (listed, ends, failing) = pooled(measure, halves, fails, undefined);
        return over_all(measure, listed, ends, failing);
    }
    let mut without = |row: u32, column: u32| {
        undefined.get_or_insert_with(|| Fails::new(halves.rows.count, halves.columns.count)).one(row, column);
    };
    let mut failing = 0;
    let (listed, ends) = match parts {
        Parts::Sums { mut blocks, form, undefined: nowhere } => {
            for (rows, columns) in nowhere {
                rows.iter().for_each(|&row| columns.iter().for_each(|&column| without(row, column)));
            }
            let (low, high) = form.bounds(measure.low, measure.high);
            let mut limit = Limit { low, high, fails, count: 0 };
            let found = order(&mut blocks, form, Some(&mut limit));
            failing = limit.count;
            let ends = found.as_ref().map(|order| (order.at_min, order.at_max));
            (found.map(Listed::from), ends)
        }
        Parts::Extremes { rows, columns, negative } => {
            let sign = if negative { -1.0 } else { 1.0 };
            let within = |value: &Option<f64>| value.is_none_or(|value| measure.holds(sign * value));
            // The larger of two is beyond a bound on that side if either is; on the other side if both are.
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
            (weighted(&larger(&rows, &columns, negative)), extreme_ends(&rows, &columns, negative))
        }
        Parts::Pooled => (None, None),
    };
    over_all(measure, listed, ends, failing)
}

fn over_all(measure: &Measure, listed: Option<Listed>, ends: Ends, failing: u64) -> OverAll {
    let worst = listed.zip(ends).map(|(listed, (at_min, at_max))| {
        let low = if measure.at_least { true } else { -listed.min > listed.max };
        if low { (at_min, listed.min) } else { (at_max, listed.max) }
    });
    OverAll { spread: listed, failing, worst }
}

type Ends = Option<((u32, u32), (u32, u32))>;

/// Where the larger of two is least and where it is greatest.
fn extreme_ends(rows: &[Option<f64>], columns: &[Option<f64>], negative: bool) -> Ends {
    let by = |value: &Option<f64>| value.unwrap_or(f64::NEG_INFINITY);
    let least = |values: &[Option<f64>]| (0..values.len()).min_by(|a, b| by(&values[*a]).total_cmp(&by(&values[*b])));
    let most = |values: &[Option<f64>]| (0..values.len()).rev().max_by(|a, b| by(&values[*a]).total_cmp(&by(&values[*b])));
    let at_least = (least(rows)? as u32, least(columns)? as u32);
    let at_most = (most(rows)? as u32, most(columns)? as u32);
    Some(if negative { (at_most, at_least) } else { (at_least, at_most) })
}

/// From the values of every selection.
fn pooled(measure: &Measure, halves: &Halves, fails: &mut Fails, undefined: &mut Option<Fails>) -> (Option<Listed>, Ends, u64) {
    let mut list = Vec::new();
    let mut failing = 0;
    let mut without = |row: u32, column: u32| {
        undefined.get_or_insert_with(|| Fails::new(halves.rows.count, halves.columns.count)).one(row, column);
    };
    for (row, of_row) in halves.rows.choices().enumerate() {
        for (column, of_column) in halves.columns.choices().enumerate() {
            match measure.over(of_row.iter().chain(of_column).map(|&at| at as usize)) {
                None => without(row as u32, column as u32),
                Some(value) => {
                    if !measure.holds(value) {
                        fails.one(row as u32, column as u32);
                        failing += 1;
                    }
                    list.push((value, (row as u32, column as u32)));
                }
            }
        }
    }
    list.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let ends = list.first().zip(list.last()).map(|(first, last)| (first.1, last.1));
    let single: Vec<(f64, f64)> = list.into_iter().map(|(value, _)| (value, 1.0)).collect();
    (weighted(&single), ends, failing)
}

/// Marks selections with fewer signals or pairs than the protocol asks for.
fn too_few(quantity: &Quantity, halves: &Halves, undefined: &mut Option<Fails>) {
    let of = |half: &Half| -> Vec<(usize, u128)> {
        half.choices()
            .map(|choice| {
                choice.iter().fold((0, 0), |(pairs, signals), &at| {
                    (pairs + quantity.values[at as usize].len(), signals | quantity.signals[at as usize])
                })
            })
            .collect()
    };
    let (rows, columns) = (of(&halves.rows), of(&halves.columns));
    let least = |all: &[(usize, u128)]| all.iter().map(|(pairs, _)| *pairs).min().unwrap_or(0);
    let common = |all: &[(usize, u128)]| all.iter().fold(u128::MAX, |common, (_, signals)| common & signals);
    let enough = least(&rows) + least(&columns) >= quantity.minimum_pairs
        && (common(&rows) | common(&columns)).count_ones() as usize >= quantity.minimum_signals;
    if enough {
        return;
    }
    let fails = undefined.get_or_insert_with(|| Fails::new(halves.rows.count, halves.columns.count));
    for (row, (pairs, signals)) in rows.iter().enumerate() {
        for (column, (more, others)) in columns.iter().enumerate() {
            if pairs + more < quantity.minimum_pairs || ((signals | others).count_ones() as usize) < quantity.minimum_signals {
                fails.one(row as u32, column as u32);
            }
        }
    }
}

/// All selections of a case.
pub fn all(case: &Case) -> Counted {
    let halves = Halves::of(case);
    let (statistics, verdicts) = core(case, &halves);
    let combinations = halves.rows.count as u64 * halves.columns.count as u64;
    let failing = verdicts.any.count();
    let share_of = |count: u64| count as f64 / combinations as f64;
    let usable = case.usable();
    let mut worst = Vec::new();
    let mut quantities = Vec::new();
    for (at, (quantity, found)) in case.quantities.iter().zip(&statistics).enumerate() {
        let mut spreads = Vec::new();
        for (measure, over_all) in quantity.measures.iter().zip(found) {
            spreads.push(StatisticSpread {
                name: measure.name.clone(),
                title: measure.title.clone(),
                scope: measure.scope.clone(),
                limit: measure.limit,
                at_least: measure.at_least,
                spread: over_all.spread.map(spread),
                failing: share_of(over_all.failing),
                overall: measure.over(usable.iter().copied()),
            });
            if let (Some(((row, column), value)), true) = (over_all.worst, over_all.failing > 0) {
                let sections = halves.rows.choice(row as usize).iter().chain(halves.columns.choice(column as usize));
                let mut sections: Vec<usize> = sections.map(|&at| at as usize).collect();
                sections.sort_unstable();
                worst.push(WorstSelection {
                    quantity: quantity.id.clone(),
                    symbol: quantity.symbol.clone(),
                    title: measure.title.clone(),
                    scope: measure.scope.clone(),
                    normalised: value,
                    sections: sections.into_iter().map(|at| case.sections[at].clone()).collect(),
                });
            }
        }
        quantities.push(QuantitySpread {
            id: quantity.id.clone(),
            title: quantity.title.clone(),
            symbol: quantity.symbol.clone(),
            unit: quantity.unit.clone(),
            failing: share_of(verdicts.failing[at]),
            alone: verdicts.kept[at].as_ref().map(|fails| share_of(fails.besides(&verdicts.twice))),
            statistics: spreads,
        });
    }
    let validated = combinations - failing;
    Counted {
        share: Share { validated, looked_at: combinations, share: share_of(validated), exact: true, interval: None, seed: None },
        quantities,
        sections: importance(case, &halves, &verdicts.any),
        worst,
        methods: vec![
            "Every selection was looked at: nothing is sampled, and shares, quartiles, extremes and outliers are exact.".into(),
            "A selection's sums are added from those of its sections; records are not evaluated again.".into(),
        ],
    }
}

fn spread(listed: Listed) -> Spread {
    Spread {
        min: listed.min,
        q1: listed.quartiles[0],
        median: listed.quartiles[1],
        q3: listed.quartiles[2],
        max: listed.max,
        outliers: listed.outliers as u64,
        count: listed.count,
        exact: true,
    }
}

/// The share with and without every section, from the selections that do not fail.
fn importance(case: &Case, halves: &Halves, fails: &Fails) -> Vec<Importance> {
    let (rows, columns) = fails.unmarked();
    let validated: u64 = rows.iter().sum();
    let (all_rows, all_columns) = (rows.len() as u64, columns.len() as u64);
    let mut with = vec![(0_u64, 0_u64); case.sections.len()];
    for (half, unmarked, others) in [(&halves.rows, &rows, all_columns), (&halves.columns, &columns, all_rows)] {
        for (choice, count) in half.choices().zip(unmarked) {
            for &at in choice {
                with[at as usize].0 += others;
                with[at as usize].1 += count;
            }
        }
    }
    let share = |all: u64, good: u64| (all > 0).then(|| good as f64 / all as f64);
    let of = |zone: &str, at: usize| {
        let (all, good) = with[at];
        Importance {
            section: case.sections[at].clone(),
            zone: zone.to_owned(),
            with: share(all, good),
            without: share(all_rows * all_columns - all, validated - good),
        }
    };
    case.strata.iter().flat_map(|stratum| stratum.members.iter().map(|&at| of(&stratum.zone, at))).collect()
}
