//! The metrics of a protocol: limits about the same kind of number.

use indexmap::IndexSet;

use crate::check::plan::{EstimateKind, Evaluation, Limit, Plan, Quantity, Records};
use crate::result::{Direction, QuantityResult, StatisticName, StatisticResult};
use crate::run::Judged;

/// The metric of a limit, or of a quantity without one.
pub fn name(quantity: &Quantity, limit: Option<&Limit>) -> String {
    let title = limit.map(|limit| limit.estimate.title.as_str());
    let each = limit.is_some_and(|limit| matches!(limit.estimate.kind, EstimateKind::Each));
    named(quantity, title, each)
}

fn named(quantity: &Quantity, title: Option<&str>, each: bool) -> String {
    let title = title.unwrap_or("value");
    match quantity.evaluation.as_ref() {
        Evaluation::Values { records: Records::Of(of), .. } => {
            format!("{title} of {} values", of.side.in_words())
        }
        Evaluation::Values { .. } if quantity.evaluation.of_repeats() => {
            format!("{title} of repeats")
        }
        Evaluation::Values { records: Records::Spread { .. }, .. } => {
            format!("{title} of the spread")
        }
        Evaluation::Values { .. } if each => "each difference".to_string(),
        Evaluation::Values { .. } => title.to_string(),
        Evaluation::Metric { .. } | Evaluation::Combined { .. } if each || title == "value" => {
            quantity.words.comparison.clone()
        }
        Evaluation::Metric { .. } | Evaluation::Combined { .. } => {
            format!("{}, {title}", quantity.words.comparison)
        }
    }
}

/// The metric of a result.
pub fn metric_of(plan: &Plan, quantity: usize, statistic: &StatisticResult) -> String {
    plan.quantities.get(quantity).map_or_else(String::new, |quantity| {
        named(quantity, Some(&statistic.title), statistic.name == StatisticName::Each)
    })
}

/// The metrics of a protocol in the order of its quantities, and whether they have limits.
pub fn all(plan: &Plan) -> Vec<(String, bool)> {
    let mut found = IndexSet::new();
    for quantity in &plan.quantities {
        found.extend(quantity.limits.iter().map(|limit| (name(quantity, Some(limit)), true)));
        found.extend(quantity.limits.is_empty().then(|| (name(quantity, None), false)));
    }
    found.into_iter().collect()
}

pub fn names(plan: &Plan) -> Vec<String> {
    let mut names: Vec<String> = all(plan).into_iter().map(|(name, _)| name).collect();
    names.dedup();
    names
}

/// A number of a metric: what its change is measured on.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    pub metric: String,
    pub limited: bool,
    /// The limit that it is of, among those of the protocol.
    pub of: String,
    /// Value / limit with its sign where that has a meaning; without a limit the value.
    pub value: f64,
    /// The share of the limit, where there is one.
    pub share: Option<f64>,
}

/// The numbers of every metric.
pub fn numbers(plan: &Plan, judged: &Judged) -> Vec<Number> {
    let mut found = Vec::new();
    for (at, quantity) in judged.quantities.iter().enumerate() {
        for statistic in &quantity.statistics {
            let Some(ratio) = signed(statistic) else { continue };
            let limit = format!("{} {} {}", quantity.id, statistic.title, statistic.scope);
            found.push(Number {
                metric: metric_of(plan, at, statistic),
                limited: true,
                of: limit,
                value: ratio,
                share: statistic.normalised,
            });
        }
        if quantity.statistics.is_empty()
            && let (Some(value), Some(rule)) = (mean(quantity), plan.quantities.get(at))
        {
            found.push(Number {
                metric: name(rule, None),
                limited: false,
                of: quantity.id.clone(),
                value,
                share: None,
            });
        }
    }
    found
}

fn signed(statistic: &StatisticResult) -> Option<f64> {
    let ratio = Some(statistic.value? / statistic.limit?).filter(|ratio| ratio.is_finite())?;
    // The worst of several magnitudes may be of either sign.
    let each = statistic.name == StatisticName::Each;
    Some(if each && statistic.direction == Direction::Magnitude { ratio.abs() } else { ratio })
}

fn mean(quantity: &QuantityResult) -> Option<f64> {
    let sum: f64 = quantity.values.iter().map(|value| value.difference).sum();
    (!quantity.values.is_empty()).then(|| sum / quantity.values.len() as f64)
}
