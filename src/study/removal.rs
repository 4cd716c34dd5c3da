//! The smallest sets of sections whose removal changes the verdict.

use super::case::{Case, Kind};
use super::greedy;
use super::judged::{Sums, Tally};
use crate::result::Verdict;
use crate::result::study::Removal;

/// Number of sets tried; fewer where a statistic must be computed from all values.
const MOST_TRIED: usize = 300_000;
const MOST_TRIED_POOLED: usize = 20_000;
/// Number of sets for which the sections are stored.
const KEPT: usize = 20;

/// Tries sets of one section, of two, and so on. Every zone keeps the number of sections that a
/// selection takes.
pub fn smallest(case: &Case, verdict: Verdict) -> Removal {
    let sums: Vec<Vec<Sums<'_>>> = case
        .quantities
        .iter()
        .map(|quantity| quantity.measures.iter().map(Sums::of).collect())
        .collect();
    let slow = case.measures().any(|(_, measure)| {
        !matches!(measure.kind, Kind::Mean | Kind::Deviation { .. } | Kind::RootMeanSquare)
    });
    let all_sums: Vec<Vec<(f64, f64, f64)>> = sums
        .iter()
        .map(|sums| sums.iter().map(|sums| sums.add(case.usable().into_iter())).collect())
        .collect();
    let mut left = if slow { MOST_TRIED_POOLED } else { MOST_TRIED };
    let members: Vec<(usize, usize)> = case
        .strata
        .iter()
        .enumerate()
        .flat_map(|(stratum, of)| of.members.iter().map(move |&at| (stratum, at)))
        .collect();
    let spare: Vec<usize> =
        case.strata.iter().map(|stratum| stratum.members.len() - stratum.take).collect();
    let most: usize = spare.iter().sum();
    let mut removal = Removal {
        verdict,
        sets: Vec::new(),
        count: 0,
        tried: 0,
        complete: most == 0,
        larger: None,
    };
    for size in 1..=most {
        let mut search = Search {
            case,
            sums: &sums,
            all: &all_sums,
            members: &members,
            verdict,
            left,
            removed: Vec::new(),
            spare: spare.clone(),
            found: Vec::new(),
        };
        if !search.sets(0, size) {
            break;
        }
        left = search.left;
        removal.tried = size;
        removal.complete = size == most;
        if !search.found.is_empty() {
            removal.count = search.found.len();
            let named =
                |set: &Vec<usize>| set.iter().map(|&at| case.sections[at].clone()).collect();
            removal.sets = search.found.iter().take(KEPT).map(named).collect();
            break;
        }
    }
    // Statistics that must be computed from all values for each set would take too long.
    if removal.sets.is_empty() && !removal.complete && !slow {
        let named = |set: Vec<usize>| set.into_iter().map(|at| case.sections[at].clone()).collect();
        removal.larger = greedy::set(case, verdict).map(named);
    }
    removal
}

struct Search<'a> {
    case: &'a Case,
    sums: &'a [Vec<Sums<'a>>],
    /// Sums of all usable sections.
    all: &'a [Vec<(f64, f64, f64)>],
    /// Stratum and section.
    members: &'a [(usize, usize)],
    verdict: Verdict,
    left: usize,
    removed: Vec<usize>,
    /// Number of sections that each stratum can lose.
    spare: Vec<usize>,
    found: Vec<Vec<usize>>,
}

impl Search<'_> {
    /// All sets of `more` further sections from a position on; false where there were too many.
    fn sets(&mut self, from: usize, more: usize) -> bool {
        if more == 0 {
            if self.left == 0 {
                return false;
            }
            self.left -= 1;
            if self.judged() != self.verdict {
                self.found.push(self.removed.clone());
            }
            return true;
        }
        for at in from..self.members.len() {
            let (stratum, section) = self.members[at];
            if self.spare[stratum] == 0 {
                continue;
            }
            self.spare[stratum] -= 1;
            self.removed.push(section);
            let whole = self.sets(at + 1, more - 1);
            self.removed.pop();
            self.spare[stratum] += 1;
            if !whole {
                return false;
            }
        }
        true
    }

    fn judged(&self) -> Verdict {
        let kept =
            || self.members.iter().map(|(_, at)| *at).filter(|at| !self.removed.contains(at));
        let mut tally = Tally::default();
        for ((quantity, sums), all) in self.case.quantities.iter().zip(self.sums).zip(self.all) {
            let before = tally;
            for (sums, all) in sums.iter().zip(all) {
                tally.limit(
                    sums.without(*all, &self.removed, kept())
                        .map(|value| sums.measure().holds(value)),
                );
            }
            tally.quantity(&before, sums.is_empty());
            tally.missing |= !sums.is_empty() && !quantity.enough(kept());
        }
        tally.verdict(self.case.rule)
    }
}
