//! Evaluation of all selections from sums of two halves.

use std::sync::Mutex;

use rayon::prelude::*;

use super::case::Case;
use super::fails::Fails;
use super::halves::Halves;
use super::overall::{OverAll, over_all, too_few};
use super::spread::Memory;
use super::verdicts::Verdicts;
use crate::result::study::{
    Importance, QuantitySpread, Share, Spread, StatisticSpread, WorstSelection,
};
use crate::run::pool::Rule;

/// Results of an enumeration.
#[derive(Debug)]
pub struct Counted {
    pub share: Share,
    pub quantities: Vec<QuantitySpread>,
    pub sections: Vec<Importance>,
    pub worst: Vec<WorstSelection>,
    pub methods: Vec<String>,
}

/// Order statistics of every limit by quantity, and the selections that do not meet a limit.
pub fn core(case: &Case, halves: &Halves) -> (Vec<Vec<OverAll>>, Verdicts) {
    let (rows, columns) = (halves.rows.count, halves.columns.count);
    let verdicts = Mutex::new(Verdicts::new(case.rule, case.quantities.len(), rows, columns));
    // Bit sets and buffers of a finished quantity are reused.
    let spare = Mutex::new(Vec::new());
    let all = case
        .quantities
        .par_iter()
        .enumerate()
        .with_max_len(1)
        .map(|(number, quantity)| {
            let used = spare.lock().expect("no panic holds the lock").pop();
            let (mut fails, mut memory) =
                used.unwrap_or_else(|| (Fails::new(rows, columns), Memory::default()));
            fails.clear();
            let mut undefined = None;
            let mut found = Vec::new();
            for measure in &quantity.measures {
                if matches!(case.rule, Rule::AtLeastLimits(_)) {
                    let mut of_limit = Fails::new(rows, columns);
                    found.push(over_all(
                        case,
                        measure,
                        halves,
                        &mut of_limit,
                        &mut undefined,
                        &mut memory,
                    ));
                    verdicts.lock().expect("no panic holds the lock").limit(&of_limit);
                    fails.join_all(&of_limit);
                } else {
                    found.push(over_all(
                        case,
                        measure,
                        halves,
                        &mut fails,
                        &mut undefined,
                        &mut memory,
                    ));
                }
            }
            if !quantity.measures.is_empty() {
                too_few(quantity, halves, &mut undefined);
            }
            if let Some(undefined) = &undefined {
                fails.join_all(undefined);
            }
            verdicts.lock().expect("no panic holds the lock").quantity(
                number,
                &fails,
                undefined.as_ref(),
            );
            spare.lock().expect("no panic holds the lock").push((fails, memory));
            found
        })
        .collect();
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
                spread: over_all.spread.map(Spread::from),
                failing: share_of(over_all.failing),
                overall: measure.over(usable.iter().copied()),
            });
            if let (Some(((row, column), value)), true) = (over_all.worst, over_all.failing > 0) {
                let sections = halves
                    .rows
                    .choice(row as usize)
                    .iter()
                    .chain(halves.columns.choice(column as usize));
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
            alone: Some(share_of(alone[at])),
            statistics: spreads,
        });
    }
    let validated = combinations - failing;
    let counted = Counted {
        share: Share { validated, looked_at: combinations, share: share_of(validated), exact: true, interval: None, seed: None },
        quantities,
        sections: importance(case, &halves, &verdicts.any),
        worst,
        methods: vec![
            "Every selection was evaluated; shares, quartiles, extremes and outliers are exact.".into(),
            "The sums of a selection are formed from those of its sections; records are not evaluated again.".into(),
        ],
    };
    (counted, verdicts.any)
}

/// The share validated with and without every section.
fn importance(case: &Case, halves: &Halves, fails: &Fails) -> Vec<Importance> {
    let (rows, columns) = fails.unmarked();
    let validated: u64 = rows.iter().sum();
    let (all_rows, all_columns) = (rows.len() as u64, columns.len() as u64);
    let mut with = vec![(0_u64, 0_u64); case.sections.len()];
    for (half, unmarked, others) in
        [(&halves.rows, &rows, all_columns), (&halves.columns, &columns, all_rows)]
    {
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
    case.strata
        .iter()
        .flat_map(|stratum| stratum.members.iter().map(|&at| of(&stratum.zone, at)))
        .collect()
}
