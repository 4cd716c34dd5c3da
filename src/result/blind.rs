//! Diagnoses scored against truths that were withheld: plain data, in the form of `blind.json`.

use indexmap::IndexMap;
use serde::Serialize;

#[derive(Clone, Debug, Serialize)]
pub struct Blind {
    pub fishplate: &'static str,
    pub cases: Vec<Case>,
    pub scores: Vec<Score>,
    /// Named first, by what is true: counts.
    pub confusion: IndexMap<String, IndexMap<String, usize>>,
    /// Share named first by detectability: lower edge, cases, named.
    pub by_detectability: Vec<(f64, usize, usize)>,
    /// Bins of the probability of the first cause: mean probability, share that is right, cases.
    pub calibration: Vec<(f64, f64, usize)>,
}

/// One campaign.
#[derive(Clone, Debug, Serialize)]
pub struct Case {
    pub campaign: String,
    pub kind: String,
    pub truth: Vec<String>,
    pub verdict: String,
    pub named: Vec<String>,
    pub ambiguity_set: Vec<String>,
    /// Whitened size of the true effects.
    pub detectability: Option<f64>,
    pub first_is_right: bool,
    pub in_first_two: bool,
    pub in_set: bool,
    /// Of the first named effect against the truth, relative.
    pub parameter_error: Option<f64>,
    /// Share of the gap removed: as said, and with the true effects.
    pub shrink_said: Option<f64>,
    pub shrink_true: Option<f64>,
    pub probability: Option<f64>,
    /// Why there is no diagnosis or no truth.
    pub fault: Option<String>,
}

/// A share of cases with its interval (Wilson, 95 %), or a median.
#[derive(Clone, Debug, Serialize)]
pub struct Score {
    pub name: String,
    pub cases: usize,
    pub value: Option<f64>,
    pub low: Option<f64>,
    pub high: Option<f64>,
}
