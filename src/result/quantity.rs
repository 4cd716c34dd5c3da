//! Results of one quantity: values, statistics, regressions.

use serde::Serialize;

use super::{RulePlace, Spread};

/// One quantity of the protocol: its processing, its values and its verdict.
#[derive(Clone, Debug, Serialize)]
pub struct QuantityResult {
    pub id: String,
    pub title: String,
    /// Symbol for tables, if the protocol gives one (`(Y/Q)max`), else the id.
    pub symbol: String,
    /// Unit of the compared values; `-` for a dimensionless number.
    pub unit: String,
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
    pub statistics: Vec<StatisticResult>,
    /// Estimates without a limit.
    pub reported: Vec<Reported>,
    /// Number of sites of the values.
    pub n: usize,
    pub values: Vec<PairValue>,
    /// All criteria are met; `None` if not assessable.
    pub holds: Option<bool>,
    /// Why it is not assessable.
    pub reason: Option<String>,
    /// Place of its definition in the protocol.
    pub rule: RulePlace,
}

impl QuantityResult {
    /// It has no limit: it is reported alone.
    pub fn decides_nothing(&self) -> bool {
        self.statistics.is_empty() && self.holds == Some(true)
    }
}

/// One statistic over pairs of section and signal, and its limit.
#[derive(Clone, Debug, Serialize)]
pub struct StatisticResult {
    /// `mean`, `std`, `p95`, `each`, ...
    pub name: String,
    /// In words: `mean`, `standard deviation (n-1)`, `95 % value`, `each value`.
    pub title: String,
    /// Pairs included: `all`, `zone 1`.
    pub scope: String,
    /// The same by key and member: `zone` `1`, `wheelset` `2`.
    #[serde(skip_serializing_if = "Vec::is_empty", serialize_with = "as_map")]
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
    /// |value| / limit.
    pub normalised: Option<f64>,
    /// Mean and standard deviation of the values of the group, in the unit of the quantity.
    #[serde(skip)]
    pub sample: Sample,
    /// Of an estimate that is a regression with one regressor.
    #[serde(skip)]
    pub regression: Option<Box<RegressionFigure>>,
    /// Of an estimate that is a share of the values: where it divides them, in the unit of the
    /// quantity.
    #[serde(skip)]
    pub divided_at: Option<f64>,
    /// Of an estimate with regressions: regressors that are read outside their data.
    #[serde(skip)]
    pub outside: Vec<Outside>,
    pub holds: Option<bool>,
    /// Factors of the limit that depend on vehicle data.
    pub factors: Vec<LimitFactor>,
    /// The limit in the words of the protocol: `2/3 of std`.
    pub limit_text: String,
    pub reason: Option<String>,
    /// Place of the limit in the protocol.
    pub rule: RulePlace,
}

/// An estimate without a limit, of one group of values or of sections.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reported {
    /// `mean`, the name of an estimate, or an expression as written.
    pub name: String,
    pub title: String,
    /// `all`, `zone 1, wheelset 2`.
    pub scope: String,
    /// Which of their values or sections, in the words of the protocol.
    pub condition: Option<String>,
    /// Each key with its member; of a zone alone, the zone.
    #[serde(serialize_with = "as_map")]
    pub group: Vec<(String, String)>,
    /// Number of values, or of sections.
    pub count: usize,
    /// Number of independent units.
    pub n: usize,
    pub unit: String,
    pub value: Option<f64>,
    /// 95 % confidence interval, as in [`StatisticResult::interval`].
    pub interval: Option<(f64, f64)>,
    /// Why there is no value.
    pub reason: Option<String>,
    /// Place of the report in the protocol.
    pub rule: RulePlace,
}

/// What the values of a group are like; `None` where there are too few.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    pub mean: Option<f64>,
    /// With the divisor n - 1.
    pub std: Option<f64>,
}

/// A regressor that is read outside the data of its group.
#[derive(Clone, Debug, PartialEq)]
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
#[derive(Clone, Debug, PartialEq)]
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
#[derive(Clone, Debug, PartialEq)]
pub struct RegressionPoint {
    pub section: String,
    pub zone: Option<String>,
    pub signal: String,
    pub x: f64,
    pub y: f64,
}

/// The fitted line and its bound at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegressionAt {
    pub x: f64,
    pub fitted: f64,
    pub bound: Option<f64>,
}

/// A factor of a limit that depends on vehicle data.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LimitFactor {
    pub by: f64,
    /// `vehicle category is freight`
    pub because: String,
}

/// One section and signal.
#[derive(Clone, Debug, Serialize)]
pub struct PairValue {
    /// Which of several campaigns.
    pub campaign: Option<String>,
    /// Name of the section (or of the record, without sections).
    pub section: String,
    pub zone: Option<String>,
    pub signal: String,
    /// Which of the quantity's values, in words, where it has several.
    pub taken: Option<String>,
    /// Which record, where the campaign has several of a side.
    pub record: Option<String>,
    pub simulated: Option<f64>,
    pub measured: Option<f64>,
    /// What estimates are taken of: the difference; of a quantity without sides its metric, or the
    /// value that is assessed.
    pub difference: f64,
    /// Number of samples (or windows) of the measured value.
    pub samples: usize,
}

impl PairValue {
    /// The signal, and which value and record it is where there are several: `SigmaY_1, p99.85`.
    #[must_use]
    pub fn label(&self) -> String {
        [Some(&self.signal), self.taken.as_ref(), self.record.as_ref()]
            .into_iter()
            .flatten()
            .cloned()
            .collect::<Vec<_>>()
            .join(", ")
    }
}

fn as_map<S: serde::Serializer>(pairs: &[(String, String)], to: S) -> Result<S::Ok, S::Error> {
    to.collect_map(pairs.iter().map(|(key, value)| (key, value)))
}
