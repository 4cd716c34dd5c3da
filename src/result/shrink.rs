//! How far the named effects reduce the gap on data that the fit did not see.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Verdict;

/// Reduction of the gap on sections excluded from the fit.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Shrink {
    pub measure: String,
    pub before: f64,
    pub after: f64,
    pub fraction_removed: f64,
    /// 90 % interval, by resampling sections.
    pub low: f64,
    pub high: f64,
    pub held_out: bool,
    pub quantities: Vec<QuantityShrink>,
    pub verdict_before: Verdict,
    pub verdict_after: Verdict,
    /// The same over the quantities that the effects change.
    pub touched: Option<Touched>,
    /// Share of the whitened excess that each effect removes, if there are several.
    pub shares: Vec<(String, f64)>,
}

/// Data that the fit did not see.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct HeldOut {
    /// Whether the campaign names them; otherwise the gap is told by cross-validation alone.
    pub named: bool,
    /// `run = P`, or `cross-validation`.
    pub what: String,
    pub sections: Vec<String>,
    /// The gap on these sections before and after, and the removed share with its 90 % interval;
    /// nothing where no effect is named.
    pub before: Option<f64>,
    pub after: Option<f64>,
    pub fraction_removed: Option<f64>,
    pub low: Option<f64>,
    pub high: Option<f64>,
}

/// Reduction of the gap in the quantities that the effects change.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Touched {
    pub quantities: Vec<String>,
    pub before: f64,
    pub after: f64,
    pub fraction_removed: f64,
    /// 90 % interval, by resampling sections.
    pub low: f64,
    pub high: f64,
    /// Removed share of the squared differences of all values, each divided by the limit of its
    /// quantity's standard deviation.
    pub variance_explained: f64,
}

#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct QuantityShrink {
    pub id: String,
    pub normalised_std_before: Option<f64>,
    pub normalised_std_after: Option<f64>,
    pub normalised_mean_before: Option<f64>,
    pub normalised_mean_after: Option<f64>,
    /// Removed share of the sum of squared differences.
    pub variance_explained: Option<f64>,
    /// Share of the sum of squared differences that is due to the declared noise of the channels;
    /// nothing where no noise is declared.
    pub noise_floor: Option<f64>,
    /// Removed share of the part above the noise; nothing where there is no such part.
    pub variance_explained_above_noise: Option<f64>,
    /// Removed share of the root mean square of its normalised values; 90 % interval by resampling
    /// sections.
    pub fraction_removed: f64,
    pub low: f64,
    pub high: f64,
}
