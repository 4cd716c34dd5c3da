//! Selections that fail, the number of quantities that fail in each, and the only one that fails.

use rayon::prelude::*;

use super::fails::Fails;
use crate::run::pool::Rule;

/// Words joined at a time, so that they stay in the cache for all operations.
const CHUNK: usize = 512;

/// Bit sets of all selections, collected quantity by quantity.
///
/// The number of the first quantity that fails is stored in binary, one bit set per binary digit:
/// four sets for twelve quantities.
#[derive(Debug)]
pub struct Verdicts {
    rule: Rule,
    /// Fails in some quantity; after the rule is applied: is not validated.
    pub any: Fails,
    /// Fails in two or more.
    twice: Fails,
    /// Binary digits of the first quantity.
    first: Vec<Fails>,
    /// Has no value for some limit, where the verdict allows some limits to fail.
    missing: Option<Fails>,
    /// Number of limits or quantities that fail, where the verdict allows some.
    counts: Vec<u8>,
    /// Number of selections that fail, by quantity.
    pub failing: Vec<u64>,
}

impl Verdicts {
    pub fn new(rule: Rule, quantities: usize, rows: usize, columns: usize) -> Self {
        let counting = rule != Rule::EveryLimit;
        let digits = usize::BITS - quantities.saturating_sub(1).leading_zeros();
        let none = || Fails::new(rows, columns);
        Self {
            rule,
            any: none(),
            twice: none(),
            first: (0..digits).map(|_| none()).collect(),
            missing: counting.then(none),
            counts: if counting { vec![0; rows * columns] } else { Vec::new() },
            failing: vec![0; quantities],
        }
    }

    /// Adds a limit, where the verdict counts limits.
    pub fn limit(&mut self, fails: &Fails) {
        fails.tally(&mut self.counts);
    }

    /// Adds a quantity; `missing` are the selections in which it has no value.
    pub fn quantity(&mut self, number: usize, fails: &Fails, missing: Option<&Fails>) {
        if let Some((all, missing)) = self.missing.as_mut().zip(missing) {
            all.join_all(missing);
        }
        if matches!(self.rule, Rule::AtLeastQuantities(_)) {
            fails.tally(&mut self.counts);
        }
        let digits = self.first.iter_mut().enumerate().filter(|(at, _)| number >> at & 1 == 1);
        let mut digits: Vec<_> =
            digits.map(|(_, digit)| digit.words_mut().chunks_mut(CHUNK)).collect();
        let (any, twice) =
            (self.any.words_mut().chunks_mut(CHUNK), self.twice.words_mut().chunks_mut(CHUNK));
        for ((fails, any), twice) in fails.words().chunks(CHUNK).zip(any).zip(twice) {
            for digit in digits.iter_mut().filter_map(Iterator::next) {
                digit
                    .iter_mut()
                    .zip(fails)
                    .zip(&*any)
                    .for_each(|((digit, fails), any)| *digit |= fails & !any);
            }
            twice
                .iter_mut()
                .zip(fails)
                .zip(&*any)
                .for_each(|((twice, fails), any)| *twice |= fails & any);
            any.iter_mut().zip(fails).for_each(|(any, fails)| *any |= fails);
        }
        self.failing[number] = fails.count();
    }

    /// For each quantity, the number of selections in which only it fails; to be called before
    /// `apply`.
    pub fn alone(&self) -> Vec<u64> {
        let of = |number: usize| {
            let word = |at: usize| {
                let once = self.any.words()[at] & !self.twice.words()[at];
                self.first.iter().enumerate().fold(once, |word, (digit, marks)| {
                    let marks = marks.words()[at];
                    word & if number >> digit & 1 == 1 { marks } else { !marks }
                })
            };
            (0..self.any.words().len()).map(|at| u64::from(word(at).count_ones())).sum()
        };
        (0..self.failing.len()).into_par_iter().map(of).collect()
    }

    /// Applies a rule that allows some of the limits or quantities to fail.
    pub fn apply(&mut self, quantities: usize, limits: usize) {
        let allowed = match self.rule {
            Rule::EveryLimit => return,
            Rule::AtLeastQuantities(needed) => quantities.saturating_sub(needed),
            Rule::AtLeastLimits(needed) => limits.saturating_sub(needed),
        };
        if let Some(missing) = self.missing.take() {
            self.any = missing;
        }
        for row in 0..self.any.rows {
            for column in 0..self.any.columns {
                if usize::from(self.counts[row * self.any.columns + column]) > allowed {
                    self.any.fail(row as u32, column as u32);
                }
            }
        }
    }
}
