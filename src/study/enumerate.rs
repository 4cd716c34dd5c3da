//! Evaluation of all selections from sums of two halves.

use std::sync::Mutex;

use rayon::prelude::*;

use super::{
    case::{Case, Quantity},
    counted::{Counted, LimitCount, Numbers},
    fails::Fails,
    halves::Halves,
    overall::{OverAll, over_all, too_few},
    verdicts::Verdicts,
};
use crate::result::study::{Share, Spread};
use crate::run::pool::Rule;

/// Order statistics of every limit by quantity, and the selections that do not meet a limit.
pub fn core(case: &Case, halves: &Halves) -> (Vec<Vec<OverAll>>, Verdicts) {
    let (rows, columns) = (halves.rows.count, halves.columns.count);
    let verdicts = Mutex::new(Verdicts::new(case.rule, case.quantities.len(), rows, columns));
    let of_quantity = |(number, quantity): (usize, &Quantity)| {
        let mut fails = Fails::new(rows, columns);
        let mut undefined = None;
        let mut found = Vec::new();
        for measure in &quantity.measures {
            // Where the verdict counts limits, each has a set of its own.
            let counts = matches!(case.rule, Rule::AtLeastLimits(_));
            let mut own = counts.then(|| Fails::new(rows, columns));
            let marks = own.as_mut().unwrap_or(&mut fails);
            found.push(over_all(case, measure, halves, marks, &mut undefined));
            if let Some(own) = own {
                verdicts.lock().expect("no panic holds the lock").limit(&own);
                fails.join_all(&own);
            }
        }
        if !quantity.measures.is_empty() {
            too_few(quantity, halves, &mut undefined);
        }
        if let Some(undefined) = &undefined {
            fails.join_all(undefined);
        }
        let mut verdicts = verdicts.lock().expect("no panic holds the lock");
        verdicts.quantity(number, &fails, undefined.as_ref());
        found
    };
    let all = case.quantities.par_iter().enumerate().with_max_len(1).map(of_quantity).collect();
    (all, verdicts.into_inner().expect("no panic holds the lock"))
}

/// Bit set of the selections that are not validated.
pub fn fails(case: &Case, halves: &Halves) -> Fails {
    let (_, mut verdicts) = core(case, halves);
    apply(case, &mut verdicts);
    verdicts.any
}

fn apply(case: &Case, verdicts: &mut Verdicts) {
    verdicts.apply(
        case.quantities.iter().filter(|quantity| !quantity.measures.is_empty()).count(),
        case.measures().count(),
    );
}

/// Evaluates all selections of a case.
pub fn all(case: &Case) -> Counted {
    marked(case).0
}

/// Evaluates all selections of a case; returns also the bit set of those that are not validated.
pub fn marked(case: &Case) -> (Counted, Fails) {
    let halves = Halves::of(case);
    let (statistics, mut verdicts) = core(case, &halves);
    let alone = verdicts.alone();
    apply(case, &mut verdicts);
    let combinations = halves.rows.count as u64 * halves.columns.count as u64;
    let validated = combinations - verdicts.any.count();
    let share = Share::exact(validated, combinations);
    let of_limit = |found: OverAll| {
        let worst = found.worst.filter(|_| found.failing > 0);
        let worst = worst.map(|((row, column), value)| (halves.selection(row, column), value));
        LimitCount { spread: found.spread.map(Spread::from), failing: found.failing, worst }
    };
    let limits = statistics.into_iter().flatten().map(of_limit).collect();
    let numbers = Numbers {
        quantities: std::iter::zip(verdicts.failing.iter().copied(), alone).collect(),
        sections: with_each(case, &halves, &verdicts.any),
    };
    let methods = [
        "Every selection was evaluated; shares, quartiles, extremes and outliers are exact.",
        "The sums of a selection are formed from those of its sections; records are not evaluated again.",
    ];
    let methods = methods.map(str::to_owned).to_vec();
    (Counted::new(case, share, limits, &numbers, methods), verdicts.any)
}

/// For each section, the number of selections with it, and of validated ones.
fn with_each(case: &Case, halves: &Halves, fails: &Fails) -> Vec<(u64, u64)> {
    let (rows, columns) = fails.unmarked();
    let mut with = vec![(0, 0); case.sections.len()];
    for (half, unmarked, others) in
        [(&halves.rows, &rows, columns.len()), (&halves.columns, &columns, rows.len())]
    {
        for (choice, count) in half.choices().zip(unmarked) {
            for &at in choice {
                with[at as usize].0 += others as u64;
                with[at as usize].1 += count;
            }
        }
    }
    with
}
