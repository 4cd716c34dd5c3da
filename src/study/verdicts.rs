//! Which selections fail, and by how many quantities and by which one.

use rayon::prelude::*;

use super::fails::Fails;
use crate::run::pool::Rule;

/// Words joined at a time, so that they are fetched from memory once for all that is done with them.
const CHUNK: usize = 512;

/// Marks of all selections, gathered quantity by quantity.
///
/// The first quantity that a selection fails in is kept as a number in bits, one set of marks for each binary digit: with twelve
/// quantities four sets in place of twelve.
#[derive(Debug)]
pub struct Verdicts {
    rule: Rule,
    /// Fails in some quantity; once the rule was applied, is not validated.
    pub any: Fails,
    /// In two or more.
    twice: Fails,
    /// Binary digits of the first quantity.
    first: Vec<Fails>,
    /// Has no value that it needs, where a verdict allows some limits to fail.
    missing: Option<Fails>,
    /// Limits or quantities that fail, where a verdict allows some.
    counts: Vec<u8>,
    /// Selections that fail in each quantity.
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

    /// A limit by itself, where the verdict counts limits.
    pub fn limit(&mut self, fails: &Fails) {
        fails.tally(&mut self.counts);
    }

    /// A quantity, with the selections in which it has no value that it needs.
    pub fn quantity(&mut self, number: usize, fails: &Fails, missing: Option<&Fails>) {
        if let Some((all, missing)) = self.missing.as_mut().zip(missing) {
            all.join_all(missing);
        }
        if matches!(self.rule, Rule::AtLeastQuantities(_)) {
            fails.tally(&mut self.counts);
        }
        let digits = self.first.iter_mut().enumerate().filter(|(at, _)| number >> at & 1 == 1);
        let mut digits: Vec<_> = digits.map(|(_, digit)| digit.words_mut().chunks_mut(CHUNK)).collect();
        let (any, twice) = (self.any.words_mut().chunks_mut(CHUNK), self.twice.words_mut().chunks_mut(CHUNK));
        for ((fails, any), twice) in fails.words().chunks(CHUNK).zip(any).zip(twice) {
            for digit in digits.iter_mut().filter_map(Iterator::next) {
                digit.iter_mut().zip(fails).zip(&*any).for_each(|((digit, fails), any)| *digit |= fails & !any);
            }
            twice.iter_mut().zip(fails).zip(&*any).for_each(|((twice, fails), any)| *twice |= fails & any);
            any.iter_mut().zip(fails).for_each(|(any, fails)| *any |= fails);
        }
        self.failing[number] = fails.count();
    }

    /// For each quantity, the selections that fail in it and in no other; to be asked before the rule is applied.
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

    /// Marks what is not validated where a verdict allows some of so many limits or quantities to fail.
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
                    self.any.one(row as u32, column as u32);
                }
            }
        }
    }
}
