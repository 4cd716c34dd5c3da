//! How far several records of one side are from each other: simulations by several codes, or runs
//! of a measurement.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The records of a quantity, each compared with what is central of all of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Spread {
    /// What is central: `mean`, `median`.
    pub center: String,
    /// Each zone that has values, then all sections; without zones only these.
    pub classes: Vec<ClassSpread>,
}

/// The values of one class of sections.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ClassSpread {
    /// `None`: all sections.
    pub zone: Option<String>,
    /// Sections and signals at which the records are compared.
    pub places: usize,
    /// In the order of the campaign.
    pub records: Vec<OfRecord>,
    /// Of the mean deviations: largest less smallest, and standard deviation (n - 1).
    pub range_of_means: f64,
    pub std_of_means: f64,
    /// Of the deviations at one place, the same: the mean over the places.
    pub mean_range: f64,
    pub mean_std: f64,
    /// The place with the largest range, and the standard deviation there.
    pub widest: Furthest,
    pub std_at_widest: f64,
}

/// The deviations of one record from what is central of all.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OfRecord {
    pub record: String,
    pub values: usize,
    pub mean: f64,
    /// With the divisor n - 1; `None` for a single value.
    pub std: Option<f64>,
    pub rms: f64,
    pub largest: Furthest,
    /// By the root mean square of the deviations, from 1 for the smallest; equal ones have the same
    /// rank.
    pub rank: usize,
}

/// A value with its place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Furthest {
    pub value: f64,
    pub section: String,
    pub signal: String,
}
