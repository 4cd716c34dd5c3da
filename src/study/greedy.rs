//! Greedy search for a set of sections whose removal changes the verdict, for campaigns where not
//! all sets can be tried. One section is removed at a time, always the one with the largest effect.

use super::case::Case;
use super::judged::{Sums, Tally};
use crate::result::Verdict;

/// A set whose removal changes the verdict and of which no section can be restored; not necessarily
/// the smallest. Every zone keeps the number of sections that a selection takes. `None` if the
/// search finds no such set.
pub fn set(case: &Case, verdict: Verdict) -> Option<Vec<usize>> {
    let search = Search::of(case, verdict);
    let found = match verdict {
        // It is sufficient that one limit fails: each is tried, and the shortest set is kept.
        Verdict::Validated => {
            let most = search.sums.iter().map(Vec::len).sum::<usize>();
            (0..most).filter_map(|limit| search.walk(|beyond| -beyond[limit])).min_by_key(Vec::len)
        }
        // All limits must be met: the sum of the exceedances is minimised.
        _ => search.walk(|beyond| beyond.iter().map(|by| by.max(0.0)).sum()),
    };
    found.map(|found| search.shortened(found))
}

struct Search<'a> {
    case: &'a Case,
    verdict: Verdict,
    sums: Vec<Vec<Sums<'a>>>,
    /// Sums of all usable sections.
    all: Vec<Vec<(f64, f64, f64)>>,
    usable: Vec<usize>,
}

impl<'a> Search<'a> {
    fn of(case: &'a Case, verdict: Verdict) -> Self {
        let sums: Vec<Vec<Sums<'_>>> = case
            .quantities
            .iter()
            .map(|quantity| quantity.measures.iter().map(Sums::of).collect())
            .collect();
        let usable = case.usable();
        let all = sums
            .iter()
            .map(|sums| sums.iter().map(|sums| sums.add(usable.iter().copied())).collect())
            .collect();
        Self { case, verdict, sums, all, usable }
    }

    /// The verdict without some sections, and the exceedance of each limit; negative where the
    /// limit is met.
    fn without(&self, removed: &[usize]) -> (Verdict, Vec<f64>) {
        let kept = || self.usable.iter().copied().filter(|at| !removed.contains(at));
        let (mut tally, mut beyond) = (Tally::default(), Vec::new());
        for ((quantity, sums), all) in self.case.quantities.iter().zip(&self.sums).zip(&self.all) {
            let before = tally;
            for (sums, all) in sums.iter().zip(all) {
                let (measure, value) = (sums.measure(), sums.without(*all, removed, kept()));
                tally.limit(value.map(|value| measure.holds(value)));
                beyond.push(
                    value.map_or(0.0, |value| (measure.low - value).max(value - measure.high)),
                );
            }
            tally.quantity(&before, sums.is_empty());
            tally.missing |= !sums.is_empty() && !quantity.enough(kept());
        }
        (tally.verdict(self.case.rule), beyond)
    }

    /// Removes the section with the lowest cost until the verdict changes or no section can be
    /// removed.
    fn walk(&self, cost: impl Fn(&[f64]) -> f64) -> Option<Vec<usize>> {
        let mut spare: Vec<usize> =
            self.case.strata.iter().map(|stratum| stratum.members.len() - stratum.take).collect();
        let mut removed: Vec<usize> = Vec::new();
        loop {
            let mut best: Option<(f64, usize, usize, Verdict)> = None;
            for (number, stratum) in
                self.case.strata.iter().enumerate().filter(|(number, _)| spare[*number] > 0)
            {
                for &section in stratum.members.iter().filter(|at| !removed.contains(at)) {
                    let (verdict, beyond) = self.without(&[&removed[..], &[section]].concat());
                    let cost =
                        if verdict == self.verdict { cost(&beyond) } else { f64::NEG_INFINITY };
                    if best.is_none_or(|(least, ..)| cost < least) {
                        best = Some((cost, number, section, verdict));
                    }
                }
            }
            let (_, number, section, verdict) = best?;
            spare[number] -= 1;
            removed.push(section);
            if verdict != self.verdict {
                return Some(removed);
            }
        }
    }

    /// Restores the sections that are not needed, and sorts the rest.
    fn shortened(&self, mut removed: Vec<usize>) -> Vec<usize> {
        let mut at = 0;
        while at < removed.len() {
            let section = removed.remove(at);
            if self.without(&removed).0 == self.verdict {
                removed.insert(at, section);
                at += 1;
            }
        }
        removed.sort_unstable();
        removed
    }
}
