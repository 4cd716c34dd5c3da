//! How far a verdict is from another one: the smallest changes that flip it, and the probability
//! that it is the right one.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Reason, Scope, StatisticName, Verdict, told};

/// The margin of a verdict.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MarginStudy {
    pub verdict: Verdict,
    #[serde(flatten, with = "told::reasons")]
    #[schemars(with = "told::Reasons<Reason>")]
    pub reasons: Vec<Reason>,
    pub margin: Vec<Margin>,
    /// Share of the draws that have the verdict; `None` where no uncertainty is declared.
    pub probability_right: Option<f64>,
    pub probability: Option<Probability>,
}

/// What is changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Changed {
    /// The measured channel is multiplied by one plus the change.
    Gain,
    /// The change is added to the measured channel.
    Offset,
    /// The measurement is moved along the axis.
    Shift,
    /// A number or a choice of words of the protocol.
    Parameter,
    /// Sections are left out.
    Sections,
    Limit,
}

/// The changes of one kind that leave the verdict as it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Margin {
    pub change: Changed,
    /// The channel, the axis, the parameter, or the limit.
    pub of: String,
    /// From here to `high` the verdict stays; `None` where no smaller change was found that flips
    /// it.
    pub low: Option<f64>,
    pub high: Option<f64>,
    pub unit: String,
    /// It follows from estimates and limits, or all alternatives were tried. Otherwise it was
    /// searched on the grid, and the nearest flip found there was bisected.
    pub exact: bool,
    /// The verdicts beyond.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub verdict_low: Option<Verdict>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub verdict_high: Option<Verdict>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub searched: Option<Searched>,
    /// The columns that are changed together.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub columns: Vec<String>,
    /// Of a parameter: its value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub as_it_is: Option<String>,
    /// Of alternatives: those that flip the verdict, and how many were tried.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub flips_with: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tried: Option<usize>,
    /// Why it was not searched, or not farther.
    #[serde(flatten, with = "told::reason", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<told::OneReason<Reason>>")]
    pub reason: Option<Reason>,
}

impl Margin {
    pub fn new(change: Changed, of: &str, unit: &str) -> Self {
        Self {
            change,
            of: of.to_owned(),
            low: None,
            high: None,
            unit: unit.to_owned(),
            exact: false,
            verdict_low: None,
            verdict_high: None,
            searched: None,
            columns: Vec::new(),
            as_it_is: None,
            flips_with: Vec::new(),
            tried: None,
            reason: None,
        }
    }

    /// Whether some change was found that flips the verdict.
    pub fn flips(&self) -> bool {
        self.low.is_some() || self.high.is_some() || !self.flips_with.is_empty()
    }
}

/// The grid of a search, in the unit of the margin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Searched {
    pub from: f64,
    pub to: f64,
    pub step: f64,
}

/// How probable a verdict is with the declared uncertainties of the channels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Probability {
    pub draws: usize,
    pub seed: u64,
    /// 95 % Wilson interval of the share.
    pub interval_95: (f64, f64),
    pub method: String,
    pub channels: Vec<Drawn>,
    /// Every limit that the verdict depends on.
    pub limits: Vec<Risk>,
}

/// An uncertainty that was drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Drawn {
    pub channel: String,
    /// Gain or offset.
    pub of: Changed,
    /// One standard deviation.
    pub standard: f64,
    pub unit: String,
    /// One error for all columns, or one for each.
    pub correlated: bool,
    pub columns: Vec<String>,
}

/// What can be wrong about a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Wrong {
    #[serde(rename = "false acceptance")]
    FalseAcceptance,
    #[serde(rename = "false rejection")]
    FalseRejection,
}

/// The specific risk of one limit (JCGM 106:2012, 9.3), and its guard band (8.3).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Risk {
    pub quantity: String,
    pub symbol: String,
    pub statistic: StatisticName,
    #[serde(flatten)]
    pub scope: Scope,
    pub unit: String,
    pub value: f64,
    pub limit: Option<f64>,
    /// Standard deviation of the estimate over the draws.
    pub standard_uncertainty: f64,
    /// What is wrong where the result for this limit is wrong, and the share of the draws in which
    /// it is.
    pub risk_of: Wrong,
    pub risk: f64,
    pub guard_band: f64,
    /// The value is nearer to the limit than the guard band.
    pub within_guard_band: bool,
}
