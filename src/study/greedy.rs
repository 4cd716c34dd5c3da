//! Greedy search for a set of sections whose removal changes the verdict, for campaigns where not
//! all sets can be tried. One section is removed at a time, always the one with the largest effect.

use super::{case::Case, judged::Judge};
use crate::result::Verdict;

/// A set whose removal changes the verdict and of which no section can be restored; not necessarily
/// the smallest. Every zone keeps the number of sections that a selection takes. `None` if the
/// search finds no such set.
pub fn set(case: &Case, verdict: Verdict) -> Option<Vec<usize>> {
    let judge = Judge::new(case);
    let found = match verdict {
        // It is sufficient that one limit fails: each is tried, and the shortest set is kept.
        Verdict::Validated => (0..case.measures().count())
            .filter_map(|limit| walk(&judge, verdict, |beyond| -beyond[limit]))
            .min_by_key(Vec::len),
        // All limits must be met: the sum of the exceedances is minimised.
        _ => walk(&judge, verdict, |beyond| beyond.iter().map(|by| by.max(0.0)).sum()),
    };
    found.map(|found| shortened(&judge, verdict, found))
}

/// Removes the section with the lowest cost until the verdict changes or no section can be removed.
fn walk(judge: &Judge<'_>, verdict: Verdict, cost: impl Fn(&[f64]) -> f64) -> Option<Vec<usize>> {
    let mut spare = judge.case.spare();
    let mut removed: Vec<usize> = Vec::new();
    loop {
        let mut best: Option<(f64, usize, usize, Verdict)> = None;
        let stays = |(stratum, at): &(usize, usize)| spare[*stratum] > 0 && !removed.contains(at);
        for (stratum, section) in judge.case.members().filter(stays) {
            let (changed, beyond) = judge.without(&[&removed[..], &[section]].concat());
            let cost = if changed == verdict { cost(&beyond) } else { f64::NEG_INFINITY };
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, stratum, section, changed));
            }
        }
        let (_, stratum, section, changed) = best?;
        spare[stratum] -= 1;
        removed.push(section);
        if changed != verdict {
            return Some(removed);
        }
    }
}

/// Restores the sections that are not needed, and sorts the rest.
fn shortened(judge: &Judge<'_>, verdict: Verdict, mut removed: Vec<usize>) -> Vec<usize> {
    let mut at = 0;
    while at < removed.len() {
        let section = removed.remove(at);
        if judge.without(&removed).0 == verdict {
            removed.insert(at, section);
            at += 1;
        }
    }
    removed.sort_unstable();
    removed
}
