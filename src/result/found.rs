//! Sections that were found in runs, and what was rejected.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Reason, told};

/// What the search for sections gave.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FoundSections {
    /// Which of several campaigns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub campaign: Option<String>,
    /// Distance between two places that were tried, in `axis_unit`.
    pub step: f64,
    pub axis_unit: String,
    /// Which of several places that would overlap is taken, in words.
    pub prefer: String,
    pub runs: Vec<FoundInRun>,
}

/// The search in one run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FoundInRun {
    pub run: String,
    /// The part of the run that all its records cover.
    pub start: f64,
    pub end: f64,
    pub found: usize,
    /// Places that were tried; those inside a found section were not.
    pub tried: usize,
    /// For each reason, how many places it rejected first.
    pub rejected: Vec<Rejected>,
    /// Stretches of places next to each other that were rejected for the same reason.
    pub stretches: Vec<Stretch>,
    /// Shift of the measurement against the simulation along the run, where it can be estimated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drift: Option<Drift>,
}

/// What would have to be added to the distance of the measurement, along a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Drift {
    /// At the sections that were found.
    pub points: Vec<DriftPoint>,
    /// In windows along the whole run.
    pub along: Vec<CoursePoint>,
    /// How many windows were looked at; in the others the shift is not certain.
    pub windows: usize,
    /// Whether it was added.
    pub corrected: bool,
}

/// The shift at a section, in `axis_unit`, with its 95 % interval.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DriftPoint {
    pub section: String,
    pub start: f64,
    pub shift: f64,
    pub low: f64,
    pub high: f64,
    /// Correlation of both sides at this shift.
    pub correlation: f64,
}

/// The shift in the middle of a window, in `axis_unit` of the simulation, with its 95 % interval.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CoursePoint {
    pub at: f64,
    pub shift: f64,
    pub low: f64,
    pub high: f64,
    pub correlation: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Rejected {
    #[serde(flatten, with = "told::reason")]
    #[schemars(with = "told::OneReason<Reason>")]
    pub reason: Reason,
    pub places: usize,
}

/// Places next to each other where no section begins, for the same reason.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Stretch {
    pub from: f64,
    pub to: f64,
    #[serde(flatten, with = "told::reason")]
    #[schemars(with = "told::OneReason<Reason>")]
    pub reason: Reason,
    pub places: usize,
}

impl FoundSections {
    pub fn found(&self) -> usize {
        self.runs.iter().map(|run| run.found).sum()
    }

    pub fn tried(&self) -> usize {
        self.runs.iter().map(|run| run.tried).sum()
    }

    /// Of all runs: each reason, with the number of places that it rejected first.
    pub fn rejected(&self) -> Vec<Rejected> {
        let mut all: Vec<Rejected> = Vec::new();
        for one in self.runs.iter().flat_map(|run| &run.rejected) {
            match all.iter_mut().find(|known| known.reason == one.reason) {
                Some(known) => known.places += one.places,
                None => all.push(one.clone()),
            }
        }
        all
    }
}
