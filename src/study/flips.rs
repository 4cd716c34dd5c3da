//! Selections whose verdict changes with other values of the same sections.

use super::{
    Settings,
    case::Case,
    enumerate::fails,
    fails::Fails,
    halves::Halves,
    judged::Judge,
    random::{Count, draw_until},
};
use crate::metrics::interval::wilson;
use crate::result::{Reason, Verdict, study::Flips};

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
pub fn flips(before: Marked<'_>, after: Marked<'_>, settings: &Settings) -> Result<Flips, Reason> {
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
    let (before, after) = (Judge::new(one), Judge::new(two));
    let none = || Changes { before: &before, after: &after, lost: 0, gained: 0 };
    let (found, all) = draw_until(one, settings, none);
    Flips {
        compared: all as f64,
        lost: found.lost as f64 / all as f64,
        gained: found.gained as f64 / all as f64,
        exact: false,
        lost_interval: Some(wilson(found.lost, all)),
        gained_interval: Some(wilson(found.gained, all)),
    }
}

/// Numbers of random selections that are no longer validated, and that newly are.
struct Changes<'a> {
    before: &'a Judge<'a>,
    after: &'a Judge<'a>,
    lost: u64,
    gained: u64,
}

impl Count for Changes<'_> {
    fn look(&mut self, selection: Vec<usize>) {
        let [before, after] = [self.before, self.after]
            .map(|judge| judge.over(&selection, |_, _, _| {}).verdict == Verdict::Validated);
        self.lost += u64::from(before && !after);
        self.gained += u64::from(!before && after);
    }

    fn join(&mut self, other: Self) {
        self.lost += other.lost;
        self.gained += other.gained;
    }

    fn width(&self, all: u64) -> f64 {
        let width = |count: u64| {
            let (low, high) = wilson(count, all);
            high - low
        };
        width(self.lost).max(width(self.gained))
    }
}
