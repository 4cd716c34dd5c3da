//! Scores of diagnoses against withheld truths: plain data, in the form of `blind.json`.

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Blind {
    pub fishplate: String,
    pub format: u32,
    pub cases: Vec<Case>,
    pub scores: Vec<Score>,
    /// Number of cases by truth and by the effect named first.
    pub confusion: IndexMap<String, IndexMap<String, usize>>,
    /// Single effects by detectability, in increasing order.
    pub by_detectability: Vec<BySize>,
    /// Bins of the probability of the first cause.
    pub calibration: Vec<Calibration>,
}

/// Single effects with a detectability from `from` to the next bin: number, number named first, and
/// the interval of the share (Wilson, 95 %).
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct BySize {
    pub from: f64,
    pub cases: usize,
    pub named: usize,
    pub low: f64,
    pub high: f64,
}

/// First causes of similar probability: mean probability, number of correct ones, and the interval
/// of the share (Wilson, 95 %).
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Calibration {
    pub said: f64,
    pub cases: usize,
    pub right: usize,
    pub low: f64,
    pub high: f64,
}

/// Result of one campaign.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct Case {
    pub campaign: String,
    pub kind: String,
    pub truth: Vec<String>,
    pub verdict: String,
    pub named: Vec<String>,
    pub ambiguity_set: Vec<String>,
    /// Length of the whitened change by the true effects, in standard deviations.
    pub detectability: Option<f64>,
    /// With several true effects: the smallest part of one that no size of the others reproduces,
    /// in standard deviations.
    pub weakest: Option<f64>,
    pub first_is_right: bool,
    pub in_first_two: bool,
    pub in_set: bool,
    /// Relative error of the parameter of the first named effect.
    pub parameter_error: Option<f64>,
    /// Share of the gap removed: as predicted, and with the true effects.
    pub shrink_said: Option<f64>,
    pub shrink_true: Option<f64>,
    pub probability: Option<f64>,
    /// Cells of the map: changed by the truth, called significant, and both. Nothing if the truth
    /// is not in the catalogue.
    pub cells: Option<Places>,
    /// Whether the truth changes the first cell of the map; nothing if it changes none.
    pub first_cell_moved: Option<bool>,
    /// Sections of the effects that are both named and true: true ones, named ones, and both.
    /// Nothing if they act in all sections.
    pub sections: Option<Places>,
    /// Why there is no diagnosis or no truth.
    pub fault: Option<String>,
}

/// Number of true places, of reported places, and of both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Places {
    pub truly: usize,
    pub told: usize,
    pub both: usize,
}

/// A share of cases, or of places, with its interval (Wilson, 95 %), or a median.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Score {
    pub name: String,
    pub cases: usize,
    pub value: Option<f64>,
    pub low: Option<f64>,
    pub high: Option<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::result::text;

    #[test]
    fn scores_are_read_as_they_are_written() {
        let blind = Blind {
            fishplate: "0.1.0".into(),
            format: 1,
            cases: vec![
                Case { campaign: "B01".into(), detectability: Some(7.25), ..Case::default() },
                Case { cells: Some(Places { truly: 3, told: 2, both: 1 }), ..Case::default() },
            ],
            scores: vec![Score {
                name: "named".into(),
                cases: 3,
                value: Some(2.0 / 3.0),
                low: None,
                high: Some(0.1 + 0.2),
            }],
            confusion: [("friction".to_string(), [("none".to_string(), 1)].into())].into(),
            by_detectability: vec![BySize { from: 3.0, cases: 2, named: 1, low: 0.1, high: 0.9 }],
            calibration: vec![Calibration { said: 0.5, cases: 2, right: 1, low: 0.1, high: 0.9 }],
        };
        let written = text(&blind);
        let read: Blind = serde_json::from_str(&written).expect("the same form");
        assert_eq!(text(&read), written);
    }
}
