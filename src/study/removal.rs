//! The smallest sets of sections whose removal changes the verdict.

use super::{
    case::{Case, Kind},
    greedy,
    judged::Judge,
};
use crate::result::{Verdict, study::Removal};

/// Number of sets tried; fewer where a statistic must be computed from all values.
const MOST_TRIED: usize = 300_000;
const MOST_TRIED_FROM_VALUES: usize = 20_000;
/// Number of sets for which the sections are stored.
const KEPT: usize = 20;

/// Tries sets of one section, of two, and so on. Every zone keeps the number of sections that a
/// selection takes.
pub fn smallest(case: &Case, verdict: Verdict) -> Removal {
    let slow = case.measures().any(|(_, measure)| !matches!(measure.kind, Kind::Sum(_)));
    let spare = case.spare();
    let most: usize = spare.iter().sum();
    let named = |set: &[usize]| set.iter().map(|&at| case.sections[at].clone()).collect();
    let mut removal = Removal {
        verdict,
        sets: Vec::new(),
        count: 0,
        tried: 0,
        complete: most == 0,
        larger: None,
    };
    let mut search = Search {
        judge: Judge::new(case),
        members: case.members().collect(),
        verdict,
        left: if slow { MOST_TRIED_FROM_VALUES } else { MOST_TRIED },
        removed: Vec::new(),
        spare,
        found: Vec::new(),
    };
    for size in 1..=most {
        if !search.sets(0, size) {
            break;
        }
        removal.tried = size;
        removal.complete = size == most;
        if !search.found.is_empty() {
            removal.count = search.found.len();
            removal.sets = search.found.iter().take(KEPT).map(|set| named(set)).collect();
            break;
        }
    }
    // Statistics that must be computed from all values for each set would take too long.
    if removal.sets.is_empty() && !removal.complete && !slow {
        removal.larger = greedy::set(case, verdict).map(|set| named(&set));
    }
    removal
}

struct Search<'a> {
    judge: Judge<'a>,
    /// Stratum and section.
    members: Vec<(usize, usize)>,
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
            if self.judge.without(&self.removed).0 != self.verdict {
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
}
