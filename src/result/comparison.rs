//! Result of a comparison of protocols over campaigns.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{FileHash, Reason, Scope, told};

/// Every number of a comparison; the keys of `comparison.json`.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Comparison {
    pub fishplate: String,
    pub format: u32,
    pub protocols: Vec<Compared>,
    pub campaigns: Vec<OnCampaign>,
    pub verdicts: Vec<Cell>,
    /// Every limit of every protocol on every campaign.
    pub ratios: Vec<Ratio>,
    pub agreement: Vec<Agreement>,
    pub sensitivity: Vec<Sensitivity>,
    pub applicability: Vec<Applicability>,
    /// Of exactly two related protocols: what differs, and what each difference does; empty
    /// otherwise.
    pub differences: Vec<Difference>,
    /// Of two protocols that are no variants of each other: the number of rules that differ.
    pub unrelated: Option<usize>,
    /// The scores of single sections that agreement is computed from.
    pub scores: Vec<Score>,
    pub work: Work,
}

/// A protocol of the comparison.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Compared {
    pub name: String,
    pub title: String,
    pub edition: Option<String>,
    pub sha256: String,
    /// Names of its metrics.
    pub metrics: Vec<String>,
    /// Criterion of its overall verdict.
    pub criterion: String,
    pub files: Vec<super::ProtocolFile>,
}

/// A campaign of the comparison.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct OnCampaign {
    pub name: String,
    pub sections: usize,
    pub files: Vec<FileHash>,
}

/// The verdict of a protocol on a campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Cell {
    pub campaign: String,
    pub protocol: String,
    /// In the words of the protocol.
    pub verdict: String,
    /// `true` if it holds, `false` if not; `None` if it is not assessable or open.
    pub holds: Option<bool>,
    /// The quantity and estimate with the largest ratio to its limit.
    pub decided_by: Option<String>,
    pub ratio: Option<f64>,
    pub sections_used: usize,
    /// Why the verdict does not hold or is not assessable.
    #[serde(flatten, with = "told::reasons")]
    #[schemars(with = "told::Reasons<Reason>")]
    pub reasons: Vec<Reason>,
}

/// One limit of one protocol on one campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Ratio {
    pub campaign: String,
    pub protocol: String,
    pub metric: String,
    pub quantity: String,
    pub symbol: String,
    pub estimate: String,
    #[serde(flatten)]
    pub scope: Scope,
    pub unit: String,
    pub value: Option<f64>,
    pub limit: Option<f64>,
    /// As [`Direction::share`](super::Direction::share).
    pub ratio: Option<f64>,
    pub holds: Option<bool>,
    #[serde(flatten, with = "told::reason")]
    #[schemars(with = "told::NoneOrReason<Reason>")]
    pub reason: Option<Reason>,
}

/// The largest ratio of a section, of a metric or of a protocol.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Score {
    pub campaign: String,
    pub section: String,
    pub protocol: String,
    /// `None` of the protocol as a whole.
    pub metric: Option<String>,
    /// `None` where a value has no ratio to a limit that it does not reach: worse than any ratio.
    pub score: Option<f64>,
    /// Then how far the value is below the limit, as a share of the limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shortfall: Option<f64>,
    /// Whether the score is a ratio to a limit; else how far the value is from the best one.
    pub limited: bool,
}

/// Agreement of two protocols, or of two metrics of one protocol.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Agreement {
    /// `protocols` or `metrics`.
    pub of: String,
    /// The protocol of two metrics.
    pub protocol: Option<String>,
    pub a: String,
    pub b: String,
    /// Number of sections that both give a score.
    pub sections: usize,
    /// Sections by requirement met and not met: rows by `a`, columns by `b`. `None` where a metric
    /// has no limit.
    pub contingency: Option<[[usize; 2]; 2]>,
    /// Spearman's rank correlation of the scores.
    pub spearman: Option<f64>,
    /// Why there is no correlation.
    #[serde(flatten, with = "told::reason")]
    #[schemars(with = "told::NoneOrReason<Reason>")]
    pub reason: Option<Reason>,
    /// Campaigns by verdict: holds, does not hold, not assessable; of protocols only.
    pub verdicts: Option<[[usize; 3]; 3]>,
}

/// How far a metric moves with a disturbance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Sensitivity {
    pub metric: String,
    pub protocol: String,
    /// `offset`, `gain`, `time shift`, `noise`, `choice of sections`.
    pub disturbance: String,
    pub sizes: Vec<f64>,
    /// Root mean square, over all limits of the metric and all campaigns, of the change of value /
    /// limit.
    pub values: Vec<Option<f64>>,
    /// Why a value is missing.
    #[serde(flatten, with = "told::reasons")]
    #[schemars(with = "told::EachReason<Reason>")]
    pub reasons: Vec<Option<Reason>>,
    /// The largest ratio of value and limit.
    pub largest: Vec<Option<f64>>,
    /// Number of verdicts of the protocol that differ from those of the records as they are.
    pub verdicts_changed: Vec<usize>,
    /// Number of verdicts looked at.
    pub verdicts: usize,
    /// Whether values are ratios to limits; else they are in the unit of the metric.
    pub limited: bool,
    pub by_campaign: Vec<OfCampaign>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OfCampaign {
    pub campaign: String,
    pub values: Vec<Option<f64>>,
}

/// What a metric can be applied to, found by trying.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Applicability {
    pub protocol: String,
    pub metric: String,
    /// The campaign it was tried on.
    pub campaign: Option<String>,
    /// Number of quantities with the metric.
    pub quantities: usize,
    /// Whether doubled records leave its values as they are, double them, or neither: `relative`,
    /// `absolute`, `neither`.
    pub scale: Option<String>,
    /// Whether it stays the same in magnitude when simulation and measurement are exchanged.
    pub symmetric: Option<bool>,
    /// Tries with the values of one quantity alone that give a number.
    pub number_of_one_quantity: Tried,
    /// Tries with one section alone that give a number.
    pub number_of_one_section: Tried,
    /// The same, for the verdict of the protocol.
    pub verdict_of_one_quantity: Tried,
    pub verdict_of_one_section: Tried,
}

/// How many of some tries gave a result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Tried {
    pub gave: usize,
    pub of: usize,
}

impl Tried {
    pub fn add(&mut self, gave: bool) {
        self.gave += usize::from(gave);
        self.of += 1;
    }
}

/// A rule that differs between two protocols, and what it does to a verdict by itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Difference {
    /// The subject: `quantity Y_max, limit std`; `all rules` for all changes together.
    pub rule: String,
    /// `std 9 kN -> std 8 kN`
    pub words: String,
    pub before: Option<String>,
    pub after: Option<String>,
    pub campaign: String,
    pub verdict_before: String,
    pub verdict_after: Option<String>,
    pub decided_by_before: Option<String>,
    pub decided_by_after: Option<String>,
    pub ratio_before: Option<f64>,
    pub ratio_after: Option<f64>,
    /// Number of limits whose value or bound is another, or that are new or gone.
    pub limits_changed: Option<usize>,
    /// Why the rule cannot be applied alone.
    #[serde(flatten, with = "told::reason")]
    #[schemars(with = "told::NoneOrReason<Reason>")]
    pub reason: Option<Reason>,
}

/// What sharing saved.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Work {
    pub records_read: usize,
    /// As often as protocols asked for them.
    pub records_asked: usize,
    /// Signals that passed a filter, records as they are.
    pub filters_run: usize,
    /// The same if each protocol had run by itself.
    pub filters_asked: usize,
    /// Operations in the processing graphs of the protocols.
    pub operations: usize,
    /// Of the hashes of all protocols, each on a line.
    pub sha256: String,
}
