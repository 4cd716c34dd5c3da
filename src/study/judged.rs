//! Evaluation of one selection from its sections: the reference for the enumeration, and the method
//! for single selections.

use super::case::{Case, Kind, Measure, Quantity};
use crate::metrics::moments::{Moments, Summed};
use crate::result::{Verdict, study::Selected};
use crate::run::pool::Rule;

/// The verdict on a selection.
#[derive(Clone, Debug)]
pub struct Judged {
    pub verdict: Verdict,
    /// Quantities that do not meet a limit or have too few values, by index.
    pub failing: Vec<usize>,
}

impl Case {
    /// All usable sections of the strata.
    pub fn usable(&self) -> Vec<usize> {
        self.strata.iter().flat_map(|stratum| stratum.members.iter().copied()).collect()
    }

    /// The verdict on some sections, and every statistic in the order of the quantities.
    pub fn judge(&self, sections: &[usize]) -> (Verdict, Vec<Selected>) {
        let mut all = Vec::new();
        let judged = self.judged(sections, |_, quantity, measure| {
            let normalised = measure.over(sections.iter().copied());
            all.push(Selected {
                id: quantity.id.clone(),
                symbol: quantity.symbol.clone(),
                name: measure.name.clone(),
                scope: measure.scope.clone(),
                holds: normalised.is_some_and(|value| measure.holds(value)),
                normalised,
            });
            normalised
        });
        (judged.verdict, all)
    }

    /// The verdict on some sections from the value of each limit, which is called by its number.
    pub fn judged(
        &self,
        sections: &[usize],
        mut value: impl FnMut(usize, &Quantity, &Measure) -> Option<f64>,
    ) -> Judged {
        let (mut number, mut missing, mut failing) = (0, false, Vec::new());
        let (mut limits_met, mut limits_failed, mut quantities_met) = (0, 0, 0);
        let with_limits = |(_, quantity): &(usize, &Quantity)| !quantity.measures.is_empty();
        for (at, quantity) in self.quantities.iter().enumerate().filter(with_limits) {
            let before = limits_failed;
            let mut lacks = !quantity.enough(sections);
            for measure in &quantity.measures {
                match value(number, quantity, measure).map(|value| measure.holds(value)) {
                    None => lacks = true,
                    Some(true) => limits_met += 1,
                    Some(false) => limits_failed += 1,
                }
                number += 1;
            }
            missing |= lacks;
            quantities_met += usize::from(limits_failed == before);
            if lacks || limits_failed > before {
                failing.push(at);
            }
        }
        let holds = match self.rule {
            Rule::EveryLimit => limits_failed == 0,
            Rule::AtLeastQuantities(needed) => quantities_met >= needed,
            Rule::AtLeastLimits(needed) => limits_met >= needed,
        };
        let verdict = match (missing, holds) {
            (true, _) => Verdict::NotAssessable,
            (false, true) => Verdict::Validated,
            (false, false) => Verdict::NotValidated,
        };
        Judged { verdict, failing }
    }
}

impl Quantity {
    /// Whether some sections have the number of signals and pairs that the protocol requires.
    pub fn enough(&self, sections: &[usize]) -> bool {
        let of_groups = self
            .minimum_of_groups
            .iter()
            .all(|group| sections.iter().map(|&at| group.pairs[at]).sum::<usize>() >= group.needed);
        let (mut pairs, mut signals) = (0, 0_u128);
        let enough = |pairs: usize, signals: u128| {
            pairs >= self.minimum_pairs && signals.count_ones() as usize >= self.minimum_signals
        };
        of_groups
            && (enough(pairs, signals)
                || sections.iter().any(|&at| {
                    pairs += self.values[at].len();
                    signals |= self.signals[at];
                    enough(pairs, signals)
                }))
    }
}

impl Measure {
    /// As a statistic that follows from sums over sections; `None` if it needs all values.
    pub fn summed(&self) -> Option<Summed> {
        match self.kind {
            Kind::Sum(moment) => Some(Summed::new(moment, self.scale, &self.values)),
            _ => None,
        }
    }
}

/// A case with the sums of its sections, so that statistics of several need no values.
#[derive(Debug)]
pub struct Judge<'a> {
    pub case: &'a Case,
    /// Of each limit, with the sums of all usable sections; `None` where values are needed.
    sums: Vec<Option<(Summed, Moments)>>,
    usable: Vec<usize>,
}

impl<'a> Judge<'a> {
    /// Forms the sums of all limits.
    pub fn new(case: &'a Case) -> Self {
        let usable = case.usable();
        let sums = case.measures().map(|(_, measure)| {
            let summed = measure.summed()?;
            let total = summed.total(usable.iter().copied());
            Some((summed, total))
        });
        Self { case, sums: sums.collect(), usable }
    }

    /// Judges some sections; `look` is told the number, the limit and the value of each.
    pub fn over(
        &self,
        sections: &[usize],
        mut look: impl FnMut(usize, &Measure, Option<f64>),
    ) -> Judged {
        self.case.judged(sections, |number, _, measure| {
            let value = match &self.sums[number] {
                Some((summed, _)) => summed.value(summed.total(sections.iter().copied())),
                None => measure.over(sections.iter().copied()),
            };
            look(number, measure, value);
            value
        })
    }

    /// The verdict without some of the usable sections, and how far each limit is exceeded;
    /// negative where it is met.
    pub fn without(&self, removed: &[usize]) -> (Verdict, Vec<f64>) {
        let kept: Vec<usize> =
            self.usable.iter().copied().filter(|at| !removed.contains(at)).collect();
        let mut beyond = Vec::new();
        let judged = self.case.judged(&kept, |number, _, measure| {
            let value = match &self.sums[number] {
                Some((summed, all)) => {
                    summed.value(all.minus(summed.total(removed.iter().copied())))
                }
                None => measure.over(kept.iter().copied()),
            };
            let by = |value: f64| (measure.low - value).max(value - measure.high);
            beyond.push(value.map_or(0.0, by));
            value
        });
        (judged.verdict, beyond)
    }
}
