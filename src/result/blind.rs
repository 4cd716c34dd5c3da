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
    /// Single effects by detectability, upwards.
    pub by_detectability: Vec<BySize>,
    /// Bins of the probability of the first cause.
    pub calibration: Vec<Calibration>,
}

/// Single effects of a detectability from `from` on, as far as the next: how many, how many named first, and the interval of the share
/// (Wilson, 95 %).
#[derive(Clone, Debug, Serialize)]
pub struct BySize {
    pub from: f64,
    pub cases: usize,
    pub named: usize,
    pub low: f64,
    pub high: f64,
}

/// First causes of about the same probability: its mean, how many are right, and the interval of the share (Wilson, 95 %).
#[derive(Clone, Debug, Serialize)]
pub struct Calibration {
    pub said: f64,
    pub cases: usize,
    pub right: usize,
    pub low: f64,
    pub high: f64,
}

/// One campaign.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Case {
    pub campaign: String,
    pub kind: String,
    pub truth: Vec<String>,
    pub verdict: String,
    pub named: Vec<String>,
    pub ambiguity_set: Vec<String>,
    /// Whitened size of the true effects.
    pub detectability: Option<f64>,
    /// Of several true effects: the least that one adds which no size of the others would, in standard deviations.
    pub weakest: Option<f64>,
    pub first_is_right: bool,
    pub in_first_two: bool,
    pub in_set: bool,
    /// Of the first named effect against the truth, relative.
    pub parameter_error: Option<f64>,
    /// Share of the gap removed: as said, and with the true effects.
    pub shrink_said: Option<f64>,
    pub shrink_true: Option<f64>,
    pub probability: Option<f64>,
    /// Cells of the map: moved by what is true, called significant, and both. Nothing where no catalogue has the truth.
    pub cells: Option<Places>,
    /// Whether what is true moves the first cell of the map; nothing where it moves none.
    pub first_cell_moved: Option<bool>,
    /// Sections in which the effects act that are named and true: in truth, as named, and both. Nothing where they act everywhere.
    pub sections: Option<Places>,
    /// Why there is no diagnosis or no truth.
    pub fault: Option<String>,
}

/// How many places are true, how many were told, and how many both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Places {
    pub truly: usize,
    pub told: usize,
    pub both: usize,
}

/// A share of cases, or of places in them, with its interval (Wilson, 95 %), or a median.
#[derive(Clone, Debug, Serialize)]
pub struct Score {
    pub name: String,
    pub cases: usize,
    pub value: Option<f64>,
    pub low: Option<f64>,
    pub high: Option<f64>,
}
