//! Parts of reasons and findings: what they are about, with names and numbers.

use indexmap::IndexSet;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A value that holds of one of several vehicles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OfVehicle {
    pub value: VehicleValue,
    pub vehicle: String,
}

/// What differs between vehicles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "code", rename_all = "kebab-case")]
pub enum VehicleValue {
    /// Whether a limit applies.
    Applies {
        applies: bool,
    },
    Si {
        value: f64,
    },
    Amount {
        value: f64,
        unit: String,
    },
}

/// A datum of a section or vehicle as it is printed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Datum {
    pub name: String,
    pub value: String,
    pub unit: Option<String>,
}

/// A verdict with the word that was given.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GivenVerdict {
    pub verdict: String,
    pub word: String,
}

/// A zone with too few sections.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ShortZone {
    pub zone: String,
    pub used: usize,
}

/// Names of sections.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "code", rename = "sections")]
pub struct Sections {
    pub names: Vec<String>,
    /// These are all of the campaign.
    pub all: bool,
}

/// Names of channels, each once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "code", rename = "channels")]
pub struct Channels {
    pub names: Vec<String>,
}

/// How far a coordinate is above (or below, if negative) the nearest point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Beyond {
    pub name: String,
    pub by: f64,
    pub unit: String,
}

/// A factor between a value and the expected one that a wrong unit of measure may cause, and which
/// unit may stand in place of which.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "code", rename = "suspected-factor")]
pub struct SuspectedFactor {
    pub by: f64,
    pub of_unit: bool,
    pub units: Option<[String; 2]>,
    /// The value is smaller by the factor, not larger.
    pub inverse: bool,
}

/// What a reason is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Subject {
    Section,
    Quantity,
    Statistic,
    Signal,
    Coordinate,
    Group,
    Verdict,
    Record,
    File,
    Check,
    Vehicle,
    Step,
}

/// A limit that is not met, of one of several groups if it has a scope. No number: the worst value
/// has none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LimitNotMet {
    pub estimate: String,
    pub scope: Option<String>,
    pub value: Option<f64>,
    pub limit: Option<f64>,
    pub unit: String,
    pub at_least: bool,
}

impl Sections {
    /// Some of a number of sections.
    pub fn of(names: &[&str], total: usize) -> Self {
        let all = names.len() == total;
        Self { names: names.iter().map(ToString::to_string).collect(), all }
    }
}

impl Channels {
    /// Of names of which some may stand several times.
    pub fn of(all: &[&str]) -> Self {
        Self {
            names: all
                .iter()
                .copied()
                .collect::<IndexSet<_>>()
                .into_iter()
                .map(Into::into)
                .collect(),
        }
    }
}

/// Records of a campaign, which has a name if there are several.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RecordsOf {
    pub records: String,
    pub campaign: Option<String>,
}

/// A rule of a verdict over limits, judged in draws of the sections.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InDraws {
    /// Of which verdict; `None` of the one without a name.
    pub verdict: Option<String>,
    /// Number of draws in which the rule holds.
    pub held: usize,
    /// Number of draws in which it cannot be judged.
    pub undefined: usize,
    pub draws: usize,
    /// In how many of the draws the rule has to hold, %.
    pub required: f64,
    /// Number of independent units in each draw.
    pub units: usize,
    /// The limit that is not met in most draws; `None` where all are always met.
    pub most_often: Option<OftenNotMet>,
}

impl InDraws {
    /// Relative tolerance for the number of draws that a share requires.
    const ROUNDING: f64 = 1e-9;

    /// Whether the rule holds in as many draws as required; `None` where that rests on draws in
    /// which it cannot be judged.
    pub fn holds(&self) -> Option<bool> {
        let needed = self.required / 100.0 * self.draws as f64 * (1.0 - Self::ROUNDING);
        if self.held as f64 >= needed {
            Some(true)
        } else if ((self.held + self.undefined) as f64) < needed {
            Some(false)
        } else {
            None
        }
    }
}

/// A limit, and the number of draws in which it is not met.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OftenNotMet {
    pub quantity: String,
    pub estimate: String,
    pub scope: Option<String>,
    pub draws: usize,
}
