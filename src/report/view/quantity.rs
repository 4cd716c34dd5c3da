//! One quantity: its statistics and limits, its worst pairs, and all its values.

use std::collections::{HashMap, HashSet};

use indexmap::IndexMap;
use serde::Serialize;

use super::groups::{self, GroupTable};
use super::reports::{self, ReportTable};
use super::spread::{self, SpreadTable};
use super::wording::limit_in_words;
use super::{FigureView, Finding, name, summary};
use crate::report::sides::Sides;
use crate::report::{estimates, figure, number};
use crate::result::{PairValue, QuantityResult, RecordName, StatisticName, StatisticResult};

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
    /// What its values are called: `Pairs` of simulated and measured ones, or `Values`.
    pub rows: &'static str,
    /// Whether values are those of one record, assessed by themselves.
    pub assessed: bool,
    /// Names of the two values of a pair: simulated and measured, a record and what is central of
    /// all, or a repeat and its original.
    pub sides: [String; 2],
    /// The same in the narrow heads of tables.
    pub short_sides: [&'static str; 2],
    pub statistics: Vec<StatisticView>,
    /// Estimates by group.
    pub groups: Vec<GroupTable>,
    /// Estimates without a limit.
    pub reported: Vec<ReportTable>,
    /// How far several records of one side are apart.
    pub spreads: Vec<SpreadTable>,
    /// Whether values are those of several records.
    pub by_record: bool,
    /// The pairs with the largest difference (or metric value), in decreasing order.
    pub worst: Vec<WorstPair>,
    /// Reference of `ratio` of the worst pairs, e.g. `limit of the standard deviation`.
    pub worst_against: Option<String>,
    pub values: Vec<ValueBlock>,
    /// Compared pairs.
    pub count: String,
    /// `None` if there are no values.
    pub figure: Option<FigureView>,
    /// Regressions of its estimates.
    pub regressions: Vec<FigureView>,
    /// Cumulative frequency of the values, where it is drawn.
    pub frequency: Option<FigureView>,
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
    pub record: String,
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
    /// Empty where there is one record of each side.
    pub record: String,
    pub zone: String,
    /// For every signal: simulated, measured, difference; without sides, only the value of the
    /// metric.
    pub cells: Vec<Vec<String>>,
}

pub(super) fn view(at: usize, quantity: &QuantityResult, work: Option<&str>) -> QuantityView {
    let decimals = number::decimals(
        &quantity.unit,
        quantity
            .values
            .iter()
            .flat_map(|pair| [Some(pair.difference), pair.simulated, pair.measured])
            .flatten(),
    );
    let (worst, worst_against) = worst(quantity, decimals);
    let sides = Sides::of(quantity);
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
        notes: quantity.notes.iter().map(|note| number::raised(note)).collect(),
        holds: Finding::of_quantity(quantity),
        reason: quantity.reason.as_deref().map(number::raised),
        has_sides: quantity.has_sides,
        rows: if sides_apart(quantity) { "Pairs" } else { "Values" },
        assessed: quantity.from.is_some(),
        sides: sides.heads(),
        short_sides: sides.short,
        statistics: stated(quantity).into_iter().map(|one| statistic(one, quantity)).collect(),
        groups: groups::tables(quantity),
        reported: reports::tables(&quantity.reported),
        spreads: spread::tables(quantity),
        by_record: quantity.values.iter().any(|pair| pair.record.is_some()),
        worst,
        worst_against,
        values: blocks(quantity, decimals),
        count: number::count(quantity.values.len() as u64),
        figure: (!quantity.values.is_empty()).then(|| pairs(at, quantity)),
        regressions: regressions(at, quantity),
        frequency: figure::has_frequency(quantity).then(|| frequency(at, quantity)),
    }
}

/// Whether its values are of a simulated and a measured record.
fn sides_apart(quantity: &QuantityResult) -> bool {
    quantity.from.is_none() && quantity.among.is_none() && !quantity.repeats
}

/// Results that have no table of their own.
fn stated(quantity: &QuantityResult) -> Vec<&StatisticResult> {
    let by_group: Vec<_> =
        estimates::condensed(quantity).into_iter().filter(estimates::OfLimit::by_group).collect();
    let among = |one: &StatisticResult| {
        by_group.iter().any(|limit| limit.results.iter().any(|other| std::ptr::eq(*other, one)))
    };
    quantity.statistics.iter().filter(|one| !among(one)).collect()
}

fn statistic(found: &StatisticResult, quantity: &QuantityResult) -> StatisticView {
    let decimals = summary::decimals(found);
    StatisticView {
        title: number::formula(&found.title),
        scope: number::formula(&found.scope.to_string()),
        unit: number::unit(&found.unit),
        count: summary::pairs_and_n(found.count, found.n),
        value: summary::value(Some(found)),
        low: number::optional(found.interval.map(|interval| interval.0), decimals),
        high: number::optional(found.interval.map(|interval| interval.1), decimals),
        limit: summary::limit(Some(found)),
        limit_text: limit_in_words(found, quantity),
        normalised: summary::normalised(Some(found)),
        holds: Finding::of_statistic(Some(found)),
        reason: found.reason.as_deref().map(number::raised),
    }
}

/// The pairs with the largest |difference|; equal ones in the order of the campaign.
fn worst(quantity: &QuantityResult, decimals: usize) -> (Vec<WorstPair>, Option<String>) {
    // The limits of an assessed quantity differ from zone to zone.
    let stated: &[StatisticResult] =
        if quantity.from.is_some() { &[] } else { &quantity.statistics };
    let yardstick = stated
        .iter()
        .find(|statistic| statistic.name == StatisticName::StandardDeviation)
        .or_else(|| stated.first())
        .filter(|statistic| statistic.unit == quantity.unit && statistic.divided_at.is_none())
        .and_then(|statistic| {
            statistic.limit.filter(|limit| *limit > 0.0).map(|limit| (statistic, limit))
        });
    let mut pairs: Vec<&PairValue> = quantity.values.iter().collect();
    pairs.sort_by(|a, b| b.difference.abs().total_cmp(&a.difference.abs()));
    let rows = pairs
        .into_iter()
        .take(WORST)
        .map(|pair| WorstPair {
            section: name(&pair.section),
            record: pair.record.as_ref().map(shortened).unwrap_or_default(),
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

/// The name of a record, shortened for a table.
fn shortened(record: &RecordName) -> String {
    name(&record.to_string())
}

/// Sections and their records as rows, signals as columns, both in order of first occurrence. A
/// position with several values of one record, which have a rule each, has several rows.
fn blocks(quantity: &QuantityResult, decimals: usize) -> Vec<ValueBlock> {
    let signals = first_seen(quantity.values.iter().map(|pair| pair.signal.as_str()));
    let width = if quantity.has_sides { SIGNALS_WITH_SIDES } else { SIGNALS_WITHOUT_SIDES };
    let mut rows: IndexMap<(&str, Option<&RecordName>, usize), HashMap<&str, &PairValue>> =
        IndexMap::new();
    let mut seen: HashMap<(&str, Option<&RecordName>, &str), usize> = HashMap::new();
    for pair in &quantity.values {
        let (section, record) = (pair.section.as_str(), pair.record.as_ref());
        let nth = seen.entry((section, record, &pair.signal)).or_default();
        rows.entry((section, record, *nth)).or_default().insert(&pair.signal, pair);
        *nth += 1;
    }
    // Rows of one section stay together.
    rows.sort_by_cached_key(|(section, ..), _| {
        quantity.values.iter().position(|pair| pair.section == **section)
    });
    let sections = |signal: &str| -> HashSet<&str> {
        quantity
            .values
            .iter()
            .filter(|pair| pair.signal == signal)
            .map(|pair| pair.section.as_str())
            .collect()
    };
    // Signals without a common section are not of one table: half of it would be empty.
    signals
        .chunk_by(|one, next| !sections(one).is_disjoint(&sections(next)))
        .flat_map(|signals| signals.chunks(width))
        .map(|signals| ValueBlock {
            signals: signals.iter().map(|signal| name(signal)).collect(),
            rows: rows
                .iter()
                .filter(|(_, cells)| signals.iter().any(|signal| cells.contains_key(signal)))
                .map(|((section, record, _), cells)| ValueRow {
                    section: name(section),
                    record: record.map(shortened).unwrap_or_default(),
                    zone: cells.values().next().map(|pair| zone(pair)).unwrap_or_default(),
                    cells: signals
                        .iter()
                        .map(|signal| {
                            cell(cells.get(signal).copied(), quantity.has_sides, decimals)
                        })
                        .collect(),
                })
                .collect(),
        })
        .collect()
}

fn cell(pair: Option<&PairValue>, has_sides: bool, decimals: usize) -> Vec<String> {
    let difference = number::optional(pair.map(|pair| pair.difference), decimals);
    if has_sides {
        let side =
            |of: fn(&PairValue) -> Option<f64>| number::optional(pair.and_then(of), decimals);
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

fn pairs(at: usize, quantity: &QuantityResult) -> FigureView {
    let shown = estimates::representatives(quantity);
    let found: Vec<String> = shown
        .into_iter()
        .map(|one| {
            format!(
                "{} ({}) {}, limit {}",
                one.title,
                one.scope,
                summary::value(Some(one)),
                summary::limit(Some(one))
            )
        })
        .collect();
    let what = match (quantity.has_sides, &quantity.from) {
        (true, _) => format!("{}, and their differences", Sides::of(quantity).against()),
        (false, Some(side)) => format!("{side} values by section with their limits"),
        (false, None) => "values of the comparison".to_owned(),
    };
    let rows = if sides_apart(quantity) { "pairs" } else { "values" };
    FigureView {
        name: format!("pairs-{at}"),
        caption: format!(
            "{}: {what}, {} {rows}",
            super::symbol(&quantity.symbol),
            number::count(quantity.values.len() as u64)
        ),
        alt: format!(
            "{}: {what} of {} {rows} in {}. {}.",
            quantity.title,
            quantity.values.len(),
            number::unit(&quantity.unit),
            found.join("; ")
        ),
    }
}

fn regressions(at: usize, quantity: &QuantityResult) -> Vec<FigureView> {
    let limits = estimates::limits(quantity);
    let of = |(nth, limit): (usize, &estimates::OfLimit<'_>)| {
        let drawn = figure::drawn(limit);
        let (first, regression) = *drawn.first()?;
        let all = limit.results.len();
        let missing = limit.results.iter().filter(|one| one.regression.is_none()).count();
        let mut some = match (drawn.len(), all) {
            (1, 1) => String::new(),
            (drawn, all) if drawn == all => format!(", {all} groups"),
            (drawn, _) => format!(", {drawn} of {all} groups"),
        };
        if drawn.len() + missing < all {
            some.push_str(" with the largest ratios");
        }
        if missing > 0 {
            some.push_str(&format!("; {missing} have no regression"));
        }
        let title = number::formula(&first.title);
        Some(FigureView {
            name: format!("regression-{at}-{nth}"),
            caption: format!(
                "{}: {title}, values over {}{some}",
                super::symbol(&quantity.symbol),
                regression.regressor
            ),
            alt: format!(
                "{}: values, regression{} and limit over {} for {} groups. The numbers are in the table of the estimate.",
                quantity.title,
                regression.bound.as_ref().map_or_else(String::new, |bound| format!(", {bound}")),
                regression.regressor,
                drawn.len()
            ),
        })
    };
    limits.iter().enumerate().filter_map(of).collect()
}

fn frequency(at: usize, quantity: &QuantityResult) -> FigureView {
    let some = |of: fn(&PairValue) -> bool| quantity.values.iter().any(of);
    let by = match (some(|value| value.record.is_some()), some(|value| value.zone.is_some())) {
        (true, _) => " by record",
        (false, true) => " by zone",
        (false, false) => "",
    };
    FigureView {
        name: format!("frequency-{at}"),
        caption: format!(
            "{}: cumulative frequency of the values{by}, with the limits",
            super::symbol(&quantity.symbol)
        ),
        alt: format!(
            "{}: cumulative frequency of {} values in {}{by}. The values are in the table of all values.",
            quantity.title,
            quantity.values.len(),
            number::unit(&quantity.unit)
        ),
    }
}
