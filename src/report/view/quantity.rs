//! One quantity: its statistics and limits, its worst pairs, and all its values.

use serde::Serialize;

use super::{FigureView, Finding, name, summary};
use crate::report::number;
use crate::result::{PairValue, QuantityResult, StatisticResult};

/// Number of worst pairs listed.
const WORST: usize = 5;
/// Number of signals side by side that fit a page, with and without simulated and measured values.
const SIGNALS_WITH_SIDES: usize = 4;
const SIGNALS_WITHOUT_SIDES: usize = 10;

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct QuantityView {
    pub id: String,
    pub title: String,
    pub symbol: String,
    /// Unit of the compared values as printed.
    pub unit: String,
    pub of: String,
    pub filter: String,
    pub processing: String,
    pub comparison: String,
    pub clause: Option<String>,
    pub source: Option<String>,
    /// Where the protocol defines it: `annex-t.fp, line 345`.
    pub rule: String,
    pub notes: Vec<String>,
    pub holds: Finding,
    pub reason: Option<String>,
    /// Whether values are simulated and measured, and not a single number of a metric.
    pub has_sides: bool,
    pub statistics: Vec<StatisticView>,
    /// The pairs with the largest difference (or metric value), in decreasing order.
    pub worst: Vec<WorstPair>,
    /// Reference of `ratio` of the worst pairs, e.g. `limit of the standard deviation`.
    pub worst_against: Option<String>,
    pub values: Vec<ValueBlock>,
    /// Compared pairs.
    pub count: String,
    /// `None` if there are no values.
    pub figure: Option<FigureView>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StatisticView {
    pub title: String,
    pub scope: String,
    pub unit: String,
    /// Pairs / n: `48 / 12`, n being the number of sites.
    pub count: String,
    pub value: String,
    /// 95 % confidence interval, lower end.
    pub low: String,
    /// 95 % confidence interval, upper end.
    pub high: String,
    pub limit: String,
    pub limit_text: String,
    pub normalised: String,
    pub holds: Finding,
    pub reason: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct WorstPair {
    pub section: String,
    pub zone: String,
    pub signal: String,
    pub simulated: String,
    pub measured: String,
    pub difference: String,
    /// |difference| divided by the limit named in `worst_against`.
    pub ratio: String,
    /// Number of samples or windows of the measured signal.
    pub samples: String,
}

/// Values of up to four signals (ten without sides), one row per section.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ValueBlock {
    pub signals: Vec<String>,
    pub rows: Vec<ValueRow>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ValueRow {
    pub section: String,
    pub zone: String,
    /// For every signal: simulated, measured, difference; without sides, only the value of the metric.
    pub cells: Vec<Vec<String>>,
}

pub(super) fn view(at: usize, quantity: &QuantityResult, work: Option<&str>) -> QuantityView {
    let decimals = number::decimals(
        &quantity.unit,
        quantity.values.iter().flat_map(|pair| [Some(pair.difference), pair.simulated, pair.measured]).flatten(),
    );
    let (worst, worst_against) = worst(quantity, decimals);
    QuantityView {
        id: quantity.id.clone(),
        title: quantity.title.clone(),
        symbol: super::symbol(&quantity.symbol),
        unit: number::unit(&quantity.unit),
        of: quantity.of.clone(),
        filter: quantity.filter.clone(),
        processing: quantity.processing.clone(),
        comparison: number::formula(&quantity.comparison),
        clause: quantity.clause.clone(),
        source: quantity.source.as_deref().map(|source| super::with_work(source, work)),
        rule: format!("{}, line {}", quantity.rule.file, quantity.rule.line),
        notes: quantity.notes.clone(),
        holds: Finding::of_quantity(quantity),
        reason: quantity.reason.clone(),
        has_sides: quantity.has_sides,
        statistics: quantity.statistics.iter().map(statistic).collect(),
        worst,
        worst_against,
        values: blocks(quantity, decimals),
        count: number::count(quantity.values.len() as u64),
        figure: (!quantity.values.is_empty()).then(|| figure(at, quantity)),
    }
}

fn statistic(found: &StatisticResult) -> StatisticView {
    let decimals = summary::decimals(found);
    StatisticView {
        title: found.title.clone(),
        scope: found.scope.clone(),
        unit: number::unit(&found.unit),
        count: summary::pairs_and_n(found.count, found.n),
        value: summary::value(Some(found)),
        low: number::optional(found.interval.map(|interval| interval.0), decimals),
        high: number::optional(found.interval.map(|interval| interval.1), decimals),
        limit: summary::limit(Some(found)),
        limit_text: number::formula(&found.limit_text),
        normalised: summary::normalised(Some(found)),
        holds: Finding::of_statistic(Some(found)),
        reason: found.reason.clone(),
    }
}

/// The pairs with the largest |difference|; equal ones in the order of the campaign.
fn worst(quantity: &QuantityResult, decimals: usize) -> (Vec<WorstPair>, Option<String>) {
    let yardstick = quantity
        .statistics
        .iter()
        .find(|statistic| statistic.name == "std")
        .or_else(|| quantity.statistics.first())
        .filter(|statistic| statistic.unit == quantity.unit)
        .and_then(|statistic| statistic.limit.filter(|limit| *limit > 0.0).map(|limit| (statistic, limit)));
    let mut pairs: Vec<&PairValue> = quantity.values.iter().collect();
    pairs.sort_by(|a, b| b.difference.abs().total_cmp(&a.difference.abs()));
    let rows = pairs
        .into_iter()
        .take(WORST)
        .map(|pair| WorstPair {
            section: name(&pair.section),
            zone: zone(pair),
            signal: name(&pair.signal),
            simulated: number::optional(pair.simulated, decimals),
            measured: number::optional(pair.measured, decimals),
            difference: number::fixed(pair.difference, decimals),
            ratio: number::optional(yardstick.map(|(_, limit)| pair.difference.abs() / limit), 2),
            samples: number::count(pair.samples as u64),
        })
        .collect();
    (rows, yardstick.map(|(statistic, _)| format!("limit of the {}", statistic.title)))
}

/// Sections as rows, signals as columns, both in order of first occurrence.
fn blocks(quantity: &QuantityResult, decimals: usize) -> Vec<ValueBlock> {
    let signals = first_seen(quantity.values.iter().map(|pair| pair.signal.as_str()));
    let sections = first_seen(quantity.values.iter().map(|pair| pair.section.as_str()));
    let width = if quantity.has_sides { SIGNALS_WITH_SIDES } else { SIGNALS_WITHOUT_SIDES };
    let cells: std::collections::HashMap<(&str, &str), &PairValue> =
        quantity.values.iter().map(|pair| ((pair.section.as_str(), pair.signal.as_str()), pair)).collect();
    let zones: std::collections::HashMap<&str, String> = quantity.values.iter().map(|pair| (pair.section.as_str(), zone(pair))).collect();
    signals
        .chunks(width)
        .map(|signals| ValueBlock {
            signals: signals.iter().map(|signal| name(signal)).collect(),
            rows: sections
                .iter()
                .filter(|section| signals.iter().any(|signal| cells.contains_key(&(**section, *signal))))
                .map(|section| ValueRow {
                    section: name(section),
                    zone: zones.get(section).cloned().unwrap_or_default(),
                    cells: signals
                        .iter()
                        .map(|signal| cell(cells.get(&(*section, *signal)).copied(), quantity.has_sides, decimals))
                        .collect(),
                })
                .collect(),
        })
        .collect()
}

fn cell(pair: Option<&PairValue>, has_sides: bool, decimals: usize) -> Vec<String> {
    let difference = number::optional(pair.map(|pair| pair.difference), decimals);
    if has_sides {
        let side = |of: fn(&PairValue) -> Option<f64>| number::optional(pair.and_then(of), decimals);
        vec![side(|pair| pair.simulated), side(|pair| pair.measured), difference]
    } else {
        vec![difference]
    }
}

/// Unique names in order of first occurrence.
fn first_seen<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut seen = indexmap::IndexSet::new();
    seen.extend(names);
    seen.into_iter().collect()
}

fn zone(pair: &PairValue) -> String {
    pair.zone.as_deref().map(name).unwrap_or_default()
}

fn figure(at: usize, quantity: &QuantityResult) -> FigureView {
    let found: Vec<String> = quantity
        .statistics
        .iter()
        .map(|one| format!("{} ({}) {}, limit {}", one.title, one.scope, summary::value(Some(one)), summary::limit(Some(one))))
        .collect();
    let what = if quantity.has_sides { "simulated against measured values, and their differences" } else { "values of the comparison" };
    FigureView {
        name: format!("pairs-{at}"),
        caption: format!("{}: {what}, {} pairs", super::symbol(&quantity.symbol), number::count(quantity.values.len() as u64)),
        alt: format!(
            "{}: {what} of {} pairs in {}. {}.",
            quantity.title,
            quantity.values.len(),
            number::unit(&quantity.unit),
            found.join("; ")
        ),
    }
}
