//! Results of one quantity: values, statistics, regressions.

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    Direction, PairValue, Reason, RulePlace, Scope, Spread, StatisticName, scope::map, told,
};

/// One quantity of the protocol: its processing, its values and its verdict.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct QuantityResult {
    pub id: String,
    pub title: String,
    /// Unit of the compared values; `-` for a dimensionless number.
    pub unit: String,
    /// Number of values.
    pub pairs: usize,
    /// Number of sites of the values.
    pub n: usize,
    #[serde(flatten)]
    pub figures: Figures,
    /// All criteria are met; `None` if not assessable.
    pub holds: Option<bool>,
    /// Of several outcomes that the protocol puts in order, the one that applies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outcome: Option<String>,
    /// Why it is not assessable.
    #[serde(flatten, with = "told::reason")]
    #[schemars(with = "told::NoneOrReason<Reason>")]
    pub reason: Option<Reason>,
    /// Place of its definition in the protocol.
    pub rule: RulePlace,
    pub statistics: Vec<StatisticResult>,
    /// Of an assessment: its statistics once more, with what their groups have in common.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub groups: Option<Vec<GroupResult>>,
    /// Estimates without a limit.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reported: Vec<Reported>,
    pub values: Vec<PairValue>,
    /// Symbol for tables, if the protocol gives one (`(Y/Q)max`), else the id.
    pub symbol: String,
    /// Signals in words: `Y at wheelsets 1, 3`.
    pub of: String,
    /// Filter in words, or `none`.
    pub filter: String,
    /// Processing in words: `median`, `larger of |p0.15|, |p99.85|`.
    pub processing: String,
    /// Comparison of simulated and measured: `simulated - measured`, or the metric.
    pub comparison: String,
    pub clause: Option<String>,
    pub source: Option<String>,
    pub notes: Vec<String>,
    /// Whether `values` contain simulated and measured values; false for a metric that gives one
    /// number for both signals, and for an assessment.
    pub has_sides: bool,
    /// The record that is assessed by itself: `measured`; `None` where records are compared.
    pub from: Option<String>,
    /// The side whose records are compared with each other, or with what is central of them:
    /// `simulated`.
    pub among: Option<String>,
    /// What stands on the other side there, if not all of them: a title.
    pub against: Option<String>,
    /// Whether sections that were measured again are compared with their originals: `simulated` is
    /// the repeat, `measured` the original.
    pub repeats: bool,
    /// How far several records of one side are apart.
    pub spread: Option<Spread>,
}

/// What represents a quantity in a file: mean and standard deviation of all its values, or the
/// statistic closest to its limit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Figures {
    /// Of the records of one side.
    Assessed {
        assessed: String,
        statistic: Option<StatisticName>,
        value: Option<f64>,
        limit: Option<f64>,
    },
    Metric {
        metric: String,
        statistic: Option<StatisticName>,
        value: Option<f64>,
        limit: Option<f64>,
    },
    /// Last, since a file in which all of these are missing would be read as it.
    Moments {
        mean: Option<f64>,
        std: Option<f64>,
        limit_mean: Option<f64>,
        limit_std: Option<f64>,
        normalised_mean: Option<f64>,
        normalised_std: Option<f64>,
    },
}

impl Default for Figures {
    fn default() -> Self {
        Self::Metric { metric: String::new(), statistic: None, value: None, limit: None }
    }
}

impl QuantityResult {
    /// It has no limit: it is reported alone.
    pub fn decides_nothing(&self) -> bool {
        self.statistics.is_empty() && self.holds == Some(true)
    }

    /// With what its file states beside its statistics and values.
    pub fn completed(mut self) -> Self {
        self.pairs = self.values.len();
        let mean = self.overall(&StatisticName::Mean);
        let std = self.overall(&StatisticName::StandardDeviation);
        self.figures = if self.has_sides && (mean.is_some() || std.is_some()) {
            Figures::Moments {
                mean: mean.and_then(|mean| mean.value),
                std: std.and_then(|std| std.value),
                limit_mean: mean.and_then(|mean| mean.limit),
                limit_std: std.and_then(|std| std.limit),
                normalised_mean: mean.and_then(|mean| mean.normalised),
                normalised_std: std.and_then(|std| std.normalised),
            }
        } else {
            // A value without a ratio does not reach its limit.
            let share = |statistic: &StatisticResult| match (statistic.normalised, statistic.holds)
            {
                (Some(share), _) => share,
                (None, Some(false)) => f64::INFINITY,
                (None, _) => f64::NEG_INFINITY,
            };
            let worst = self.statistics.iter().max_by(|a, b| share(a).total_cmp(&share(b)));
            let statistic = worst.map(|worst| worst.name.clone());
            let value = worst.and_then(|worst| worst.value);
            let limit = worst.and_then(|worst| worst.limit);
            match self.from.clone() {
                Some(assessed) => Figures::Assessed { assessed, statistic, value, limit },
                None => {
                    Figures::Metric { metric: self.comparison.clone(), statistic, value, limit }
                }
            }
        };
        self.groups =
            self.from.as_ref().map(|_| self.statistics.iter().map(GroupResult::of).collect());
        self
    }

    /// The limit that values without limits of their own are set against: that of the standard
    /// deviation, or else the first one. Those of an assessed quantity differ from zone to zone.
    pub fn yardstick(&self) -> Option<(&StatisticResult, f64)> {
        let pooled = |one: &&StatisticResult| one.name != StatisticName::Each;
        let all = || self.statistics.iter().filter(|_| self.from.is_none()).filter(pooled);
        let one = all().find(|one| one.name == StatisticName::StandardDeviation).or(all().next())?;
        let same = one.unit == self.unit && one.divided_at.is_none();
        Some((one, one.limit.filter(|limit| same && *limit > 0.0)?))
    }

    /// The values with the share of their limit, the worst first; equal ones in the order of the
    /// campaign.
    pub fn worst_first(&self) -> Vec<(&PairValue, Option<f64>)> {
        let (own, yardstick) =
            (self.values.iter().any(|one| one.limit.is_some()), self.yardstick());
        let least = self.statistics.first().is_some_and(|one| one.direction == Direction::AtLeast);
        let of = |pair: &'_ PairValue| {
            let (share, limited) = match yardstick {
                _ if own => (pair.ratio, pair.limit.is_some()),
                Some((one, limit)) => (one.direction.share(pair.difference, limit), true),
                None => (None, false),
            };
            // One without a share does not reach its limit.
            let size = if least { -pair.difference } else { pair.difference.abs() };
            (limited, if limited { share.unwrap_or(f64::INFINITY) } else { 0.0 }, size, share)
        };
        let mut all: Vec<_> = self.values.iter().map(|pair| (pair, of(pair))).collect();
        all.sort_by(|(_, a), (_, b)| {
            b.0.cmp(&a.0).then(b.1.total_cmp(&a.1)).then(b.2.total_cmp(&a.2))
        });
        all.into_iter().map(|(pair, (.., share))| (pair, share)).collect()
    }

    /// A statistic of all its values.
    pub fn overall(&self, name: &StatisticName) -> Option<&StatisticResult> {
        self.statistics.iter().find(|statistic| statistic.is_overall(name))
    }
}

/// One statistic over pairs of section and signal, and its limit.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct StatisticResult {
    /// `mean`, `std`, `p95`, `each`, ...
    pub name: StatisticName,
    /// In words: `mean`, `standard deviation (n-1)`, `95 % value`, `each value`.
    pub title: String,
    /// Pairs included.
    #[serde(flatten)]
    pub scope: Scope,
    /// Each key with its member, one zone first; empty where the zone alone tells groups apart.
    #[serde(default, skip_serializing_if = "Vec::is_empty", with = "map")]
    #[schemars(with = "IndexMap<String, String>")]
    pub group: Vec<(String, String)>,
    /// Number of pairs.
    pub count: usize,
    /// Number of sites of the pairs. Pairs of one site (its positions, its repeats) are not
    /// independent.
    pub n: usize,
    /// Unit of value and limit.
    pub unit: String,
    pub value: Option<f64>,
    /// 95 % confidence interval where defined, for independent sites and n - 1 degrees of freedom
    /// (mean: Student's t; standard deviation: chi-square).
    pub interval: Option<(f64, f64)>,
    /// The interval contains the limit: another choice of sections could change the result.
    pub marginal: bool,
    pub limit: Option<f64>,
    #[serde(default, skip_serializing_if = "Direction::is_default")]
    pub direction: Direction,
    /// The lower and the upper edge of a limit `between` two. What else is here is of the edge of
    /// which more is used.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub edges: Vec<EdgeResult>,
    /// As [`Direction::share`].
    pub normalised: Option<f64>,
    /// Mean and standard deviation of the values of the group, in the unit of the quantity.
    pub sample: Sample,
    /// Of an estimate that is a regression with one regressor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub regression: Option<Box<RegressionFigure>>,
    /// Of an estimate that is a share of the values: where it divides them, in the unit of the
    /// quantity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub divided_at: Option<f64>,
    /// Of an estimate with regressions: regressors that are read outside their data.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outside: Vec<Outside>,
    /// Of an estimate with regressions that lies far beyond its values: the least and the largest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beyond: Option<(f64, f64)>,
    pub holds: Option<bool>,
    /// Factors of the limit that depend on vehicle data.
    pub factors: Vec<LimitFactor>,
    /// The limit in the words of the protocol: `2/3 of limit of std`.
    pub limit_text: String,
    /// The same as printed: `2/3 of the limit of std`.
    pub limit_printed: String,
    #[serde(flatten, with = "told::reason")]
    #[schemars(with = "told::NoneOrReason<Reason>")]
    pub reason: Option<Reason>,
    /// Place of the limit in the protocol.
    pub rule: RulePlace,
}

/// A statistic against one edge of a limit between two; of `each`, the value that is worst for it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EdgeResult {
    pub direction: Direction,
    pub limit: Option<f64>,
    pub value: Option<f64>,
    pub normalised: Option<f64>,
    pub holds: Option<bool>,
}

impl StatisticResult {
    /// What is compared: each edge of a limit between two, or the whole.
    pub fn compared(&self) -> Vec<EdgeResult> {
        let Self { direction, limit, value, normalised, holds, .. } = *self;
        match self.edges.is_empty() {
            true => vec![EdgeResult { direction, limit, value, normalised, holds }],
            false => self.edges.clone(),
        }
    }

    /// The limits between which it must be.
    pub fn between(&self) -> Option<(f64, f64)> {
        let [lower, upper] = self.edges.as_slice() else { return None };
        lower.limit.zip(upper.limit)
    }

    /// Whether it is this statistic, of all values of its quantity.
    pub fn is_overall(&self, name: &StatisticName) -> bool {
        self.name == *name && self.scope.is_all()
    }
}

/// A statistic of one group of an assessed quantity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GroupResult {
    /// Each key with its member, one zone first.
    #[serde(with = "map")]
    #[schemars(with = "IndexMap<String, String>")]
    pub keys: Vec<(String, String)>,
    pub estimate: StatisticName,
    /// Number of values.
    pub values: usize,
    pub n: usize,
    /// Mean and standard deviation of the values, in the unit of the quantity.
    #[serde(flatten)]
    pub sample: Sample,
    pub value: Option<f64>,
    pub low: Option<f64>,
    pub high: Option<f64>,
    pub limit: Option<f64>,
    /// As of a [`StatisticResult`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub edges: Vec<EdgeResult>,
    pub ratio: Option<f64>,
    pub holds: Option<bool>,
    #[serde(flatten, with = "told::reason")]
    #[schemars(with = "told::NoneOrReason<Reason>")]
    pub reason: Option<Reason>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub regression: Option<GroupRegression>,
}

/// The line of a regression with one regressor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GroupRegression {
    pub regressor: String,
    /// Of the regressor.
    pub unit: String,
    pub intercept: f64,
    pub slope: f64,
    pub target: f64,
}

impl GroupResult {
    fn of(statistic: &StatisticResult) -> Self {
        let line = |figure: &RegressionFigure| GroupRegression {
            regressor: figure.regressor.clone(),
            unit: figure.regressor_unit.clone(),
            intercept: figure.intercept,
            slope: figure.slope,
            target: figure.target,
        };
        Self {
            keys: statistic.scope.owned_members(),
            estimate: statistic.name.clone(),
            values: statistic.count,
            n: statistic.n,
            sample: statistic.sample,
            value: statistic.value,
            low: statistic.interval.map(|(low, _)| low),
            high: statistic.interval.map(|(_, high)| high),
            limit: statistic.limit,
            edges: statistic.edges.clone(),
            ratio: statistic.normalised,
            holds: statistic.holds,
            reason: statistic.reason.clone(),
            regression: statistic.regression.as_deref().map(line),
        }
    }
}

/// An estimate without a limit, of one group of values or of sections.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Reported {
    /// Each key with its member, one zone first.
    #[serde(with = "map")]
    #[schemars(with = "IndexMap<String, String>")]
    pub keys: Vec<(String, String)>,
    /// Which of their values or sections, in the words of the protocol.
    #[serde(rename = "where")]
    pub condition: Option<String>,
    #[serde(rename = "estimate")]
    pub name: StatisticName,
    pub title: String,
    /// Of which values or sections, whatever the condition.
    #[serde(flatten)]
    pub scope: Scope,
    #[serde(flatten)]
    pub count: Count,
    /// Number of independent units.
    pub n: usize,
    pub unit: String,
    pub value: Option<f64>,
    /// 95 % confidence interval, as in [`StatisticResult::interval`].
    pub low: Option<f64>,
    pub high: Option<f64>,
    /// Why there is no value.
    #[serde(flatten, with = "told::reason")]
    #[schemars(with = "told::NoneOrReason<Reason>")]
    pub reason: Option<Reason>,
    /// Place of the report in the protocol.
    pub rule: RulePlace,
}

/// The number of what an estimate is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Count {
    Values(usize),
    Sections(usize),
}

impl Count {
    pub fn number(self) -> usize {
        let (Self::Values(number) | Self::Sections(number)) = self;
        number
    }
}

/// What the values of a group are like; `None` where there are too few.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Sample {
    pub mean: Option<f64>,
    /// With the divisor n - 1.
    pub std: Option<f64>,
}

/// A regressor that is read outside the data of its group.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Outside {
    /// The regressor in the words of the protocol.
    pub regressor: String,
    pub unit: String,
    /// Where it is read, and the least and the largest of its data.
    pub target: f64,
    pub low: f64,
    pub high: f64,
}

/// A regression of values over one regressor, ready to draw.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RegressionFigure {
    /// The regressor in the words of the protocol.
    pub regressor: String,
    pub regressor_unit: String,
    pub points: Vec<RegressionPoint>,
    /// In the units of quantity and regressor.
    pub intercept: f64,
    pub slope: f64,
    /// From the smallest regressor or target to the largest.
    pub curve: Vec<RegressionAt>,
    /// What the bound is of, in words: `99 % prediction bound`; `None` where the estimate is the
    /// fitted value.
    pub bound: Option<String>,
    /// Regressor at which the estimate is taken, and the estimate.
    pub target: f64,
    pub value: f64,
}

/// A value over its regressor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RegressionPoint {
    pub section: String,
    pub zone: Option<String>,
    pub signal: String,
    pub x: f64,
    pub y: f64,
}

/// The fitted line and its bound at one place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RegressionAt {
    pub x: f64,
    pub fitted: f64,
    pub bound: Option<f64>,
}

/// A factor of a limit that depends on vehicle data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LimitFactor {
    pub by: f64,
    /// `vehicle category is freight`
    #[serde(flatten, with = "told::because")]
    #[schemars(with = "told::Because<Reason>")]
    pub because: Reason,
}
