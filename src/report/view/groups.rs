//! Estimates by group: one row for each limit in the summary, one table for each limit with its
//! groups.

use serde::Serialize;

use super::summary::Limited;
use super::wording::limit_in_words;
use super::{Finding, name, summary};
use crate::report::estimates::{self, OfLimit};
use crate::report::number;
use crate::report::sides::capital;
use crate::result::{QuantityResult, StatisticResult};

/// A limit in the summary, with the group that is nearest to it or farthest beyond.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EstimateRow {
    /// The values of the decisive group; the finding is that of all.
    #[serde(flatten)]
    pub limited: Limited,
    pub estimate: String,
    /// Groups that hold: `14 of 16`.
    pub holding: String,
    /// Where the decisive group is.
    pub place: String,
}

/// All groups of one limit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GroupTable {
    pub estimate: String,
    pub limit_text: String,
    /// Unit of estimate and limit.
    pub unit: String,
    /// `Zone`, `Wheelset`
    pub keys: Vec<String>,
    /// Whether some estimate has a confidence interval.
    pub intervals: bool,
    pub rows: Vec<GroupRow>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GroupRow {
    /// The member of each key.
    pub of: Vec<String>,
    pub count: String,
    /// Of the values, in the unit of the quantity.
    pub mean: String,
    pub std: String,
    pub value: String,
    pub low: String,
    pub high: String,
    pub limit: String,
    pub normalised: String,
    pub holds: Finding,
    pub reason: Option<String>,
}

/// The condensed limits of a quantity for the summary.
pub(super) fn rows(quantity: &QuantityResult) -> Vec<EstimateRow> {
    estimates::condensed(quantity).iter().map(|limit| row(quantity, limit)).collect()
}

fn row(quantity: &QuantityResult, limit: &OfLimit<'_>) -> EstimateRow {
    let decisive = limit.decisive();
    EstimateRow {
        limited: Limited {
            holds: Finding::of(limit.holds())
                .marginal(limit.holds().is_some() && limit.results.iter().any(|one| one.marginal)),
            reason: limit.reason().map(str::to_owned),
            ..summary::limited(quantity, decisive)
        },
        estimate: number::formula(&decisive.title),
        holding: limit.holding(),
        place: if decisive.value.is_some() {
            decisive.scope.to_string()
        } else {
            number::NONE.to_owned()
        },
    }
}

/// A table for each condensed limit that has several groups.
pub(super) fn tables(quantity: &QuantityResult) -> Vec<GroupTable> {
    estimates::condensed(quantity)
        .iter()
        .filter(|limit| limit.by_group())
        .map(|limit| table(quantity, limit))
        .collect()
}

fn table(quantity: &QuantityResult, limit: &OfLimit<'_>) -> GroupTable {
    let first = limit.results[0];
    let keys = heads(limit);
    let decimals =
        number::decimals(&quantity.unit, limit.results.iter().filter_map(|one| one.sample.mean));
    let row = |one: &&StatisticResult| {
        let own = summary::decimals(one);
        GroupRow {
            of: members(one, &keys),
            count: summary::pairs_and_n(one.count, one.n),
            mean: number::optional(one.sample.mean, decimals),
            std: number::optional(one.sample.std, decimals),
            value: summary::value(Some(one)),
            low: number::optional(one.interval.map(|(low, _)| low), own),
            high: number::optional(one.interval.map(|(_, high)| high), own),
            limit: summary::limit(Some(one)),
            normalised: summary::normalised(Some(one)),
            holds: Finding::of_statistic(Some(one)),
            reason: one.reason.clone(),
        }
    };
    GroupTable {
        estimate: number::formula(&first.title),
        limit_text: limit_in_words(first, quantity),
        unit: number::unit(&first.unit),
        intervals: limit.results.iter().any(|one| one.interval.is_some()),
        rows: limit.results.iter().map(row).collect(),
        keys: keys.iter().map(|key| capital(key)).collect(),
    }
}

/// Head of a column with the whole scope.
const GROUP: &str = "group";

/// What tells the groups of a limit apart.
fn heads(limit: &OfLimit<'_>) -> Vec<String> {
    let heads = |one: &StatisticResult| {
        one.scope.members().iter().map(|(key, _)| (*key).to_owned()).collect::<Vec<_>>()
    };
    let first = heads(limit.results[0]);
    let alike = !first.is_empty() && limit.results.iter().all(|one| heads(one) == first);
    if alike { first } else { vec![GROUP.into()] }
}

fn members(one: &StatisticResult, heads: &[String]) -> Vec<String> {
    if heads == [GROUP] {
        return vec![name(&one.scope.to_string())];
    }
    one.scope.members().iter().map(|(_, member)| name(member)).collect()
}
