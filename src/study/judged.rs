//! Evaluation of one selection from its sections: the reference for the enumeration, and the method
//! for single selections.

use super::case::{Case, Kind, Measure};
use crate::metrics::reduction::Measure as Scatter;
use crate::result::Verdict;
use crate::result::study::Selected;
use crate::run::pool::Rule;

impl Case {
    /// All usable sections of the strata.
    pub fn usable(&self) -> Vec<usize> {
        self.strata.iter().flat_map(|stratum| stratum.members.iter().copied()).collect()
    }

    /// The verdict on some sections, and every statistic in the order of the quantities.
    pub fn judge(&self, sections: &[usize]) -> (Verdict, Vec<Selected>) {
        let mut all = Vec::new();
        let mut tally = Tally::default();
        for quantity in &self.quantities {
            let before = tally;
            for measure in &quantity.measures {
                let normalised = measure.over(sections.iter().copied());
                tally.limit(normalised.map(|value| measure.holds(value)));
                all.push(Selected {
                    id: quantity.id.clone(),
                    symbol: quantity.symbol.clone(),
                    name: measure.name.clone(),
                    scope: measure.scope.clone(),
                    holds: normalised.is_some_and(|value| measure.holds(value)),
                    normalised,
                });
            }
            tally.quantity(&before, quantity.measures.is_empty());
            if !quantity.measures.is_empty() && !quantity.enough(sections.iter().copied()) {
                tally.missing = true;
            }
        }
        (tally.verdict(self.rule), all)
    }
}

/// Counts of limits and quantities that are met.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    pub missing: bool,
    failing: usize,
    holding: usize,
    quantities: usize,
}

impl Tally {
    pub fn limit(&mut self, holds: Option<bool>) {
        match holds {
            None => self.missing = true,
            Some(true) => self.holding += 1,
            Some(false) => self.failing += 1,
        }
    }

    /// Completes a quantity; `before` are the counts at its start.
    pub fn quantity(&mut self, before: &Self, empty: bool) {
        if !empty && self.failing == before.failing {
            self.quantities += 1;
        }
    }

    pub fn verdict(&self, rule: Rule) -> Verdict {
        let holds = match rule {
            Rule::EveryLimit => self.failing == 0,
            Rule::AtLeastQuantities(needed) => self.quantities >= needed,
            Rule::AtLeastLimits(needed) => self.holding >= needed,
        };
        match (self.missing, holds) {
            (true, _) => Verdict::NotAssessable,
            (false, true) => Verdict::Validated,
            (false, false) => Verdict::NotValidated,
        }
    }
}

impl super::case::Quantity {
    /// Whether some sections have the number of signals and pairs that the protocol requires.
    pub fn enough(&self, sections: impl Iterator<Item = usize>) -> bool {
        if !self.minimum_of_groups.is_empty() {
            let sections: Vec<usize> = sections.collect();
            let of_groups = self.minimum_of_groups.iter();
            let of_all = of_groups.map(|group| {
                (group.needed, sections.iter().map(|&at| group.pairs[at]).sum::<usize>())
            });
            return { of_all }.all(|(needed, pairs)| pairs >= needed)
                && self.enough_in_all(sections.iter().copied());
        }
        self.enough_in_all(sections)
    }

    fn enough_in_all(&self, sections: impl Iterator<Item = usize>) -> bool {
        let mut pairs = 0;
        let mut signals = 0_u128;
        for at in sections {
            pairs += self.values[at].len();
            signals |= self.signals[at];
            if pairs >= self.minimum_pairs && signals.count_ones() as usize >= self.minimum_signals
            {
                return true;
            }
        }
        self.minimum_pairs == 0 && self.minimum_signals == 0
    }
}

/// Number of values, sum and sum of squares of every section, so that a statistic of several does
/// not need their values.
#[derive(Clone, Debug)]
pub struct Sums<'a> {
    measure: &'a Measure,
    center: f64,
    sections: Vec<(f64, f64, f64)>,
}

impl<'a> Sums<'a> {
    pub fn of(measure: &'a Measure) -> Self {
        let all: Vec<f64> = measure.values.iter().flatten().copied().collect();
        let center = if measure.kind == Kind::RootMeanSquare {
            0.0
        } else {
            all.iter().sum::<f64>() / all.len().max(1) as f64
        };
        let sections = measure
            .values
            .iter()
            .map(|values| {
                let centred: Vec<f64> = values.iter().map(|value| value - center).collect();
                (
                    values.len() as f64,
                    centred.iter().sum(),
                    centred.iter().map(|value| value * value).sum(),
                )
            })
            .collect();
        Self { measure, center, sections }
    }

    /// The statistic divided by its limit; `None` where it is not defined.
    pub fn over(&self, sections: impl Iterator<Item = usize> + Clone) -> Option<f64> {
        if self.pooled() { self.measure.over(sections) } else { self.value(self.add(sections)) }
    }

    /// As [`Self::over`], from the sums of all sections less those of some.
    pub fn without(
        &self,
        all: (f64, f64, f64),
        removed: &[usize],
        kept: impl Iterator<Item = usize> + Clone,
    ) -> Option<f64> {
        if self.pooled() {
            return self.measure.over(kept);
        }
        let (n, x, xx) = self.add(removed.iter().copied());
        self.value((all.0 - n, all.1 - x, all.2 - xx))
    }

    /// Number of values, sum and sum of squares of some sections.
    pub fn add(&self, sections: impl Iterator<Item = usize>) -> (f64, f64, f64) {
        sections.fold((0.0, 0.0, 0.0), |(n, x, xx), at| {
            let (of_n, of_x, of_xx) = self.sections[at];
            (n + of_n, x + of_x, xx + of_xx)
        })
    }

    fn pooled(&self) -> bool {
        !matches!(self.measure.kind, Kind::Mean | Kind::Deviation { .. } | Kind::RootMeanSquare)
    }

    fn value(&self, (n, x, xx): (f64, f64, f64)) -> Option<f64> {
        let value = match self.measure.kind {
            Kind::Mean => self.center + x / n,
            Kind::RootMeanSquare => (xx / n).sqrt(),
            Kind::Deviation { ddof } if n > ddof as f64 => {
                ((xx - x * x / n).max(0.0) / (n - ddof as f64)).sqrt()
            }
            _ => f64::NAN,
        };
        Some(value * self.measure.scale).filter(|value| value.is_finite())
    }

    /// The same as a measure of scatter; `None` for a statistic that is none.
    pub fn scatter(&self) -> Option<Scatter> {
        let ddof = match self.measure.kind {
            Kind::Deviation { ddof } => Some(ddof as f64),
            Kind::RootMeanSquare => None,
            _ => return None,
        };
        Some(Scatter {
            ddof,
            scale: self.measure.scale,
            sums: self.sections.iter().map(|(n, x, xx)| [*n, *x, *xx]).collect(),
        })
    }

    pub fn measure(&self) -> &Measure {
        self.measure
    }
}
