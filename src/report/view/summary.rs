//! The summary: one row per quantity with mean and standard deviation, and one row per other
//! statistic.

use serde::Serialize;

use super::Finding;
use crate::report::{estimates, number};
use crate::result::{QuantityResult, StatisticName, StatisticResult};

/// A quantity as in EN 14363: limits, mean and standard deviation, and both divided by their
/// limits.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SummaryRow {
    pub id: String,
    pub symbol: String,
    pub title: String,
    pub unit: String,
    pub filter: String,
    pub processing: String,
    pub limit_std: String,
    pub limit_mean: String,
    /// Pairs / n: `48 / 12`, n being the number of sites.
    pub count: String,
    pub mean: String,
    pub std: String,
    pub normalised_mean: String,
    pub normalised_std: String,
    pub mean_finding: Finding,
    pub std_finding: Finding,
    pub holds: Finding,
    pub reason: Option<String>,
}

/// A statistic of a quantity against its limit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Limited {
    pub id: String,
    pub symbol: String,
    pub title: String,
    pub unit: String,
    /// Pairs / n: `48 / 12`, n being the number of sites.
    pub count: String,
    pub value: String,
    pub limit: String,
    pub normalised: String,
    pub holds: Finding,
    pub reason: Option<String>,
}

/// A statistic other than mean and standard deviation over all pairs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FurtherRow {
    #[serde(flatten)]
    pub limited: Limited,
    pub filter: String,
    pub processing: String,
    pub comparison: String,
    pub statistic: String,
    pub scope: String,
}

pub(super) fn tables(quantities: &[QuantityResult]) -> (Vec<SummaryRow>, Vec<FurtherRow>) {
    let mut summary = Vec::new();
    let mut further = Vec::new();
    for quantity in quantities {
        // An assessed quantity has its estimates in a table of its own.
        if quantity.from.is_some() && !quantity.statistics.is_empty() {
            continue;
        }
        let mean = quantity.overall(&StatisticName::Mean);
        let std = quantity.overall(&StatisticName::StandardDeviation);
        // A quantity without statistics is listed with its reason. One without a limit that has
        // values stands in its chapter.
        let without_limit =
            quantity.decides_nothing() && quantity.reason.is_none() && !quantity.values.is_empty();
        if mean.is_some() || std.is_some() || quantity.statistics.is_empty() && !without_limit {
            summary.push(summary_row(quantity, mean, std));
        }
        let single = estimates::single(quantity).into_iter();
        let others = single.filter(|one| {
            !one.is_overall(&StatisticName::Mean)
                && !one.is_overall(&StatisticName::StandardDeviation)
        });
        further.extend(others.map(|statistic| further_row(quantity, statistic)));
    }
    (summary, further)
}

fn summary_row(
    quantity: &QuantityResult,
    mean: Option<&StatisticResult>,
    std: Option<&StatisticResult>,
) -> SummaryRow {
    let either = mean.or(std);
    SummaryRow {
        id: quantity.id.clone(),
        symbol: super::symbol(&quantity.symbol),
        title: quantity.title.clone(),
        unit: number::unit(&quantity.unit),
        filter: quantity.filter.clone(),
        processing: quantity.processing.clone(),
        limit_std: limit(std),
        limit_mean: limit(mean),
        count: either.map_or_else(
            || pairs_and_n(quantity.values.len(), quantity.n),
            |one| pairs_and_n(one.count, one.n),
        ),
        mean: value(mean),
        std: value(std),
        normalised_mean: normalised(mean),
        normalised_std: normalised(std),
        mean_finding: Finding::of_statistic(mean),
        std_finding: Finding::of_statistic(std),
        holds: Finding::of_quantity(quantity),
        reason: quantity.reason.clone(),
    }
}

pub(super) fn limited(quantity: &QuantityResult, statistic: &StatisticResult) -> Limited {
    let one = Some(statistic);
    Limited {
        id: quantity.id.clone(),
        symbol: super::symbol(&quantity.symbol),
        title: quantity.title.clone(),
        unit: number::unit(&statistic.unit),
        count: pairs_and_n(statistic.count, statistic.n),
        value: value(one),
        limit: limit(one),
        normalised: normalised(one),
        holds: Finding::of_statistic(one),
        reason: statistic.reason.clone(),
    }
}

fn further_row(quantity: &QuantityResult, statistic: &StatisticResult) -> FurtherRow {
    FurtherRow {
        limited: limited(quantity, statistic),
        filter: quantity.filter.clone(),
        processing: quantity.processing.clone(),
        comparison: quantity.comparison.clone(),
        statistic: number::formula(&statistic.title),
        scope: statistic.scope.to_string(),
    }
}

/// Number of pairs and of sites.
pub(super) fn pairs_and_n(pairs: usize, n: usize) -> String {
    format!("{} / {}", number::count(pairs as u64), number::count(n as u64))
}

/// The limit, with the decimals of the value.
pub(super) fn limit(statistic: Option<&StatisticResult>) -> String {
    let Some(statistic) = statistic else { return number::NONE.to_owned() };
    number::optional(statistic.limit, decimals(statistic))
}

/// Decimals of a statistic: those of its unit, or more if the limit (or else the value) needs them
/// to show two digits.
pub(super) fn decimals(statistic: &StatisticResult) -> usize {
    number::decimals(&statistic.unit, statistic.limit.or(statistic.value))
}

/// The value with the decimals of its unit, or more if the comparison with the limit needs them.
pub(super) fn value(statistic: Option<&StatisticResult>) -> String {
    let Some(statistic) = statistic else { return number::NONE.to_owned() };
    let Some(value) = statistic.value else { return number::NONE.to_owned() };
    match statistic.limit {
        Some(limit) => number::beside(value, limit, decimals(statistic)),
        None => number::fixed(value, decimals(statistic)),
    }
}

/// |value| / limit with two decimals, or more close to 1.
pub(super) fn normalised(statistic: Option<&StatisticResult>) -> String {
    statistic
        .and_then(|statistic| statistic.normalised)
        .map_or_else(|| number::NONE.to_owned(), number::ratio)
}
