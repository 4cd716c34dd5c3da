//! The smallest sets of changed rules that give the new verdict.

use super::{
    touched::Mask,
    verdicts::{Found, Verdicts},
};
use crate::result::Outcome;

/// So many changed rules on which the verdict of a campaign depends are combined in all ways.
pub const MOST_RULES: usize = 20;

/// Sets of which none contains another.
#[derive(Debug, Default)]
pub struct Minimal {
    pub sets: Vec<Mask>,
    /// Whether these are all.
    pub exact: bool,
    /// The largest number of rules in the sets that were looked at.
    pub most: usize,
    pub looked_at: usize,
}

/// All sets that give a verdict which the empty set does not give, by size: a set that contains one
/// found before is not looked at. Each is judged once more as a whole before it is told.
/// `complete`: whether all parts of the verdict were seen under all combinations.
pub fn minimal(verdicts: &mut Verdicts<'_>, wanted: Outcome, complete: bool) -> Minimal {
    let rules = verdicts.relevant();
    let all = complete && rules.len() <= MOST_RULES;
    let most = if all { rules.len() } else { rules.len().min(1) };
    let mut found = Minimal { exact: all, most, ..Minimal::default() };
    for size in 1..=most {
        each_of_size(&rules, size, &mut |set| {
            if found.sets.iter().any(|known| known & set == *known) {
                return;
            }
            found.looked_at += 1;
            match verdicts.of(set) {
                Found::Verdict(outcome) if outcome == wanted => match verdicts.whole(set) {
                    Found::Verdict(outcome) if outcome == wanted => found.sets.push(set),
                    Found::Refused => {}
                    // The parts do not stand for the whole.
                    Found::Verdict(_) | Found::Unknown => found.exact = false,
                },
                Found::Verdict(_) | Found::Refused => {}
                Found::Unknown => found.exact = false,
            }
        });
    }
    if !all && found.sets.is_empty() {
        found.sets.push(shrunk(verdicts, wanted));
    }
    found
}

/// All rules, without those that can be left out one after the other.
fn shrunk(verdicts: &mut Verdicts<'_>, wanted: Outcome) -> Mask {
    let rules = (0..Mask::BITS).map(|at| 1 << at);
    rules.fold(verdicts.all(), |set, bit| {
        let fewer = set & !bit;
        let enough = fewer != set && verdicts.of(fewer) == Found::Verdict(wanted);
        if enough { fewer } else { set }
    })
}

/// The sets of so many of some bits, in a fixed order.
fn each_of_size(bits: &[Mask], size: usize, see: &mut dyn FnMut(Mask)) {
    fn more(bits: &[Mask], size: usize, set: Mask, see: &mut dyn FnMut(Mask)) {
        if size == 0 {
            return see(set);
        }
        for (at, bit) in bits.iter().enumerate().take(bits.len() + 1 - size) {
            more(&bits[at + 1..], size - 1, set | bit, see);
        }
    }
    if size <= bits.len() {
        more(bits, size, 0, see);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_of_a_size_are_all_there_once() {
        for size in 0..=6 {
            let mut found = Vec::new();
            each_of_size(&[1, 2, 4, 16, 64], size, &mut |set| found.push(set));
            let all = (0_u64..128).filter(|set| set & !0b101_0111 == 0);
            let mut wanted: Vec<Mask> =
                all.filter(|set| set.count_ones() as usize == size).collect();
            found.sort_unstable();
            wanted.sort_unstable();
            assert_eq!(found, wanted, "{size}");
        }
    }
}
