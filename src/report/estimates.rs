//! The estimates of a quantity, limit by limit: a limit by group has one result for each group,
//! often hundreds in all.

use crate::result::{QuantityResult, Reason, StatisticResult};

/// A limit of a quantity and what was found of it.
#[derive(Clone, Debug)]
pub struct OfLimit<'a> {
    /// One for each group, in order; at least one.
    pub results: Vec<&'a StatisticResult>,
}

impl<'a> OfLimit<'a> {
    /// The result nearest to its limit or farthest beyond: one that fails before one that holds
    /// before one that is not assessed.
    pub fn decisive(&self) -> &'a StatisticResult {
        let rank = |one: &StatisticResult| {
            let (value, limit) = one.value.zip(one.limit)?;
            Some(one.direction.badness(value, limit, one.holds?))
        };
        let mut decisive = self.results[0];
        for one in &self.results[1..] {
            if rank(one) > rank(decisive) {
                decisive = one;
            }
        }
        decisive
    }

    fn count(&self, holds: Option<bool>) -> usize {
        self.results.iter().filter(|one| one.holds == holds).count()
    }

    /// Whether all groups hold; `None` where some could not be assessed and no other fails.
    pub fn holds(&self) -> Option<bool> {
        if self.count(Some(false)) > 0 {
            return Some(false);
        }
        (self.count(None) == 0).then_some(true)
    }

    /// `14 of 16`, `12 of 16; 4 not assessed`
    pub fn holding(&self) -> String {
        let open = match self.count(None) {
            0 => String::new(),
            open => format!("; {open} not assessed"),
        };
        format!("{} of {}{open}", self.count(Some(true)), self.results.len())
    }

    /// Why the limit is not assessed: the first reason of a group. Where a group fails, that is no
    /// reason of what the limit came to.
    pub fn reason(&self) -> Option<&'a Reason> {
        if self.holds().is_some() {
            return None;
        }
        self.results.iter().find(|one| one.holds.is_none()).and_then(|one| one.reason.as_ref())
    }

    /// Whether there are several groups.
    pub fn by_group(&self) -> bool {
        self.results.len() > 1
    }
}

/// The limits of a quantity, in the order of the protocol.
pub fn limits(quantity: &QuantityResult) -> Vec<OfLimit<'_>> {
    let mut limits: Vec<OfLimit<'_>> = Vec::new();
    for one in &quantity.statistics {
        let same = |other: &StatisticResult| {
            (&other.name, &other.limit_text, &other.rule) == (&one.name, &one.limit_text, &one.rule)
        };
        match limits.iter_mut().find(|limit| same(limit.results[0])) {
            Some(limit) => limit.results.push(one),
            None => limits.push(OfLimit { results: vec![one] }),
        }
    }
    limits
}

/// The limits that are printed as one row with their decisive group: all of an assessed quantity;
/// of others those by group of more than a zone.
pub fn condensed(quantity: &QuantityResult) -> Vec<OfLimit<'_>> {
    let mut limits = limits(quantity);
    limits.retain(|limit| {
        quantity.from.is_some() || limit.by_group() && !limit.results[0].scope.keys.is_empty()
    });
    limits
}

/// Which of some limits a result belongs to.
fn of<'l, 'a>(limits: &'l [OfLimit<'a>], one: &StatisticResult) -> Option<&'l OfLimit<'a>> {
    limits.iter().find(|limit| limit.results.iter().any(|other| std::ptr::eq(*other, one)))
}

/// The results that belong to none of some limits.
pub fn others<'a>(
    quantity: &'a QuantityResult,
    limits: &[OfLimit<'_>],
) -> Vec<&'a StatisticResult> {
    quantity.statistics.iter().filter(|one| of(limits, one).is_none()).collect()
}

/// The results that are printed each by itself.
pub fn single(quantity: &QuantityResult) -> Vec<&StatisticResult> {
    others(quantity, &condensed(quantity))
}

/// The decisive result of each condensed limit, and all others.
pub fn representatives(quantity: &QuantityResult) -> Vec<&StatisticResult> {
    let condensed = condensed(quantity);
    let decides = |one: &&StatisticResult| {
        of(&condensed, one).is_none_or(|limit| std::ptr::eq(limit.decisive(), *one))
    };
    quantity.statistics.iter().filter(decides).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::result::{Direction, RulePlace, Sample, Scope, StatisticName};

    fn result(zone: &str, holds: Option<bool>, normalised: Option<f64>) -> StatisticResult {
        StatisticResult {
            name: StatisticName::Mean,
            title: "mean".into(),
            scope: Scope::zone(zone),
            group: Vec::new(),
            count: 1,
            n: 1,
            unit: "kN".into(),
            value: normalised,
            interval: None,
            marginal: false,
            limit: normalised.map(|_| 1.0),
            direction: Direction::Magnitude,
            edges: Vec::new(),
            normalised,
            sample: Sample::default(),
            regression: None,
            divided_at: None,
            outside: Vec::new(),
            beyond: None,
            holds,
            factors: Vec::new(),
            limit_text: "1 kN".into(),
            limit_printed: "1 kN".into(),
            reason: None,
            rule: RulePlace { file: "a.fp".into(), line: 1 },
        }
    }

    #[test]
    fn one_that_fails_decides_before_a_larger_ratio() {
        let all = [
            result("a", Some(true), Some(0.9)),
            result("b", Some(false), Some(0.4)),
            result("c", None, None),
            result("d", None, None),
        ];
        let limit = OfLimit { results: all.iter().collect() };
        assert_eq!(
            (limit.decisive().scope.zones[0].as_str(), limit.holds(), limit.holding().as_str()),
            ("b", Some(false), "1 of 4; 2 not assessed")
        );
        let open = OfLimit { results: vec![&all[2], &all[0]] };
        assert_eq!((open.decisive().scope.zones[0].as_str(), open.holds()), ("a", None));
    }

    #[test]
    fn a_reason_is_one_of_what_the_limit_came_to() {
        let open = StatisticResult {
            reason: Some(Reason::said("cant_deficiency does not vary")),
            ..result("c", None, None)
        };
        let [holds, fails] =
            [result("a", Some(true), Some(0.9)), result("b", Some(false), Some(1.4))];
        let reason = |results: Vec<&StatisticResult>| {
            OfLimit { results }.reason().map(|reason| reason.text().to_string())
        };
        assert_eq!(reason(vec![&holds, &open]).as_deref(), Some("cant_deficiency does not vary"));
        assert_eq!((reason(vec![&open, &fails]), reason(vec![&holds])), (None, None));
    }
}
