//! Some set of sections without which the others give another verdict, where not all sets can be tried: one section is given up
//! at a time, always the one that helps most.

use super::case::Case;
use super::judged::{Sums, Tally};
use crate::result::Verdict;

/// A set whose removal changes the verdict, none of whose sections can be put back; not surely the smallest. Every zone keeps what
/// a selection takes from it. `None` where giving up sections so leads nowhere.
pub fn set(case: &Case, verdict: Verdict) -> Option<Vec<usize>> {
    let search = Search::of(case, verdict);
    let found = match verdict {
        // One limit has to break: each is pushed by itself, and the shortest way stays.
        Verdict::Validated => {
            let most = search.sums.iter().map(Vec::len).sum::<usize>();
            (0..most).filter_map(|limit| search.walk(|beyond| -beyond[limit])).min_by_key(Vec::len)
        }
        // All have to hold: what lies beyond them together has to go.
        _ => search.walk(|beyond| beyond.iter().map(|by| by.max(0.0)).sum()),
    };
    found.map(|found| search.shortened(found))
}

struct Search<'a> {
    case: &'a Case,
    verdict: Verdict,
    sums: Vec<Vec<Sums<'a>>>,
    /// Of all usable sections.
    all: Vec<Vec<(f64, f64, f64)>>,
    usable: Vec<usize>,
}

impl<'a> Search<'a> {
    fn of(case: &'a Case, verdict: Verdict) -> Self {
        let sums: Vec<Vec<Sums<'_>>> = case.quantities.iter().map(|quantity| quantity.measures.iter().map(Sums::of).collect()).collect();
        let usable = case.usable();
        let all = sums.iter().map(|sums| sums.iter().map(|sums| sums.add(usable.iter().copied())).collect()).collect();
        Self { case, verdict, sums, all, usable }
    }

    /// The verdict without some sections, and by how much each limit is exceeded, less than none where it holds.
    fn without(&self, removed: &[usize]) -> (Verdict, Vec<f64>) {
        let kept = || self.usable.iter().copied().filter(|at| !removed.contains(at));
        let (mut tally, mut beyond) = (Tally::default(), Vec::new());
        for ((quantity, sums), all) in self.case.quantities.iter().zip(&self.sums).zip(&self.all) {
            let before = tally;
            for (sums, all) in sums.iter().zip(all) {
                let (measure, value) = (sums.measure(), sums.without(*all, removed, kept()));
                tally.limit(value.map(|value| measure.holds(value)));
                beyond.push(value.map_or(0.0, |value| (measure.low - value).max(value - measure.high)));
            }
            tally.quantity(&before, sums.is_empty());
            tally.missing |= !sums.is_empty() && !quantity.enough(kept());
        }
        (tally.verdict(self.case.rule), beyond)
    }

    /// Gives up the section whose loss costs least, until the verdict is another or no section may go.
    fn walk(&self, cost: impl Fn(&[f64]) -> f64) -> Option<Vec<usize>> {
        let mut spare: Vec<usize> = self.case.strata.iter().map(|stratum| stratum.members.len() - stratum.take).collect();
        let mut removed: Vec<usize> = Vec::new();
        loop {
            let mut best: Option<(f64, usize, usize, Verdict)> = None;
            for (number, stratum) in self.case.strata.iter().enumerate().filter(|(number, _)| spare[*number] > 0) {
                for &section in stratum.members.iter().filter(|at| !removed.contains(at)) {
                    let (verdict, beyond) = self.without(&[&removed[..], &[section]].concat());
                    let cost = if verdict == self.verdict { cost(&beyond) } else { f64::NEG_INFINITY };
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

    /// Without the sections that can be put back, and in their order.
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
