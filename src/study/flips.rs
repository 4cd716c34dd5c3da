//! Selections whose verdict changes with other values of the same sections.

use rayon::prelude::*;

use super::Settings;
use super::case::Case;
use super::enumerate::fails;
use super::fails::Fails;
use super::halves::Halves;
use super::judged::{Sums, Tally};
use super::random::{Random, draw};
use super::sampling::{BATCH, MOST_DRAWN, ROUND};
use crate::metrics::interval::wilson;
use crate::result::Verdict;
use crate::result::study::Flips;

/// A case, and the selections that are not validated if all were evaluated.
#[derive(Clone, Copy, Debug)]
pub struct Marked<'a> {
    pub case: &'a Case,
    pub fails: Option<&'a Fails>,
}

/// Compares the verdicts on all selections common to both cases, or on random ones if there are too
/// many.
///
/// # Errors
/// A zone has fewer sections usable in both cases than a selection takes.
pub fn flips(before: Marked<'_>, after: Marked<'_>, settings: &Settings) -> Result<Flips, String> {
    let (one, two) =
        (before.case.with_sections_of(after.case)?, after.case.with_sections_of(before.case)?);
    let combinations = one.combinations();
    if !settings.evaluates_all(&one) || !settings.evaluates_all(&two) {
        return Ok(drawn(&one, &two, settings));
    }
    let halves = Halves::of(&one);
    let own = |marked: Marked<'_>, case: &Case| match marked.fails {
        Some(known) if case.usable() == marked.case.usable() => known.clone(),
        _ => fails(case, &halves),
    };
    let (one, two) = (own(before, &one), own(after, &two));
    let only = |these: &Fails, others: &Fails| {
        these
            .words()
            .iter()
            .zip(others.words())
            .map(|(word, other)| u64::from((word & !other).count_ones()))
            .sum::<u64>()
    };
    let share = |count: u64| count as f64 / combinations;
    Ok(Flips {
        compared: combinations,
        lost: share(only(&two, &one)),
        gained: share(only(&one, &two)),
        exact: true,
        lost_interval: None,
        gained_interval: None,
    })
}

fn drawn(one: &Case, two: &Case, settings: &Settings) -> Flips {
    let (of_one, of_two) = (sums_of(one), sums_of(two));
    let (mut lost, mut gained, mut batches) = (0, 0, 0);
    loop {
        let found: Vec<(u64, u64)> = (batches..batches + ROUND)
            .into_par_iter()
            .map(|number| {
                let mut random = Random::new(settings.seed, number as u64);
                (0..BATCH).fold((0, 0), |(lost, gained), _| {
                    let selection = draw(one, &mut random);
                    let (before, after) =
                        (validated(one, &of_one, &selection), validated(two, &of_two, &selection));
                    (lost + u64::from(before && !after), gained + u64::from(!before && after))
                })
            })
            .collect();
        lost += found.iter().map(|(lost, _)| lost).sum::<u64>();
        gained += found.iter().map(|(_, gained)| gained).sum::<u64>();
        batches += ROUND;
        let all = (batches * BATCH) as u64;
        let (lost_interval, gained_interval) = (wilson(lost, all), wilson(gained, all));
        let widest = (lost_interval.1 - lost_interval.0).max(gained_interval.1 - gained_interval.0);
        if widest <= settings.width || batches * BATCH >= MOST_DRAWN {
            return Flips {
                compared: all as f64,
                lost: lost as f64 / all as f64,
                gained: gained as f64 / all as f64,
                exact: false,
                lost_interval: Some(lost_interval),
                gained_interval: Some(gained_interval),
            };
        }
    }
}

fn sums_of(case: &Case) -> Vec<Vec<Sums<'_>>> {
    case.quantities
        .iter()
        .map(|quantity| quantity.measures.iter().map(Sums::of).collect())
        .collect()
}

fn validated(case: &Case, sums: &[Vec<Sums<'_>>], selection: &[usize]) -> bool {
    let mut tally = Tally::default();
    for (quantity, sums) in case.quantities.iter().zip(sums) {
        let before = tally;
        for sums in sums {
            tally.limit(
                sums.over(selection.iter().copied()).map(|value| sums.measure().holds(value)),
            );
        }
        tally.quantity(&before, sums.is_empty());
        tally.missing |= !sums.is_empty() && !quantity.enough(selection.iter().copied());
    }
    tally.verdict(case.rule) == Verdict::Validated
}
