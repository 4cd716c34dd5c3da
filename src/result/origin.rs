//! Origin of simulated records, for a report.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Remark;

/// Origin of the simulated records of a campaign, where stated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OriginInfo {
    /// `fishplate 0.1.0, diagnose`
    pub made_by: String,
    /// The same with the effects, as a sentence without a full stop.
    pub says: String,
    /// `friction = 0.23`, one for each effect.
    pub effects: Vec<String>,
    /// Measured records that the simulation was fitted to: path and SHA-256.
    pub fitted_to: Vec<FittedTo>,
    /// Number of these that are measured records of this campaign, byte by byte.
    pub fitted_to_these: usize,
    /// How imported records were made; empty if none was imported.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub imported: Vec<ImportedSide>,
}

/// The imported records of one side.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ImportedSide {
    /// `measurement` or `simulation`; of several campaigns with the campaign.
    pub side: String,
    /// What each channel was made of: `Y_1L = -ST1 Y li`.
    pub channels: Vec<String>,
    pub records: Vec<ImportedOne>,
}

/// How one record was made.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ImportedOne {
    pub section: String,
    pub file: String,
    /// SHA-256 of that file.
    pub sha256: String,
    /// What was detected in the file.
    pub read_as: String,
    /// What was done, in order.
    pub steps: Vec<String>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct FittedTo {
    pub path: String,
    pub sha256: String,
}

impl OriginInfo {
    /// Whether the records were imported and nothing was changed in them by effects or a fit.
    pub fn only_imported(&self) -> bool {
        !self.imported.is_empty() && self.effects.is_empty() && self.fitted_to.is_empty()
    }

    /// Text after the verdict, following a comma.
    pub fn note(&self) -> Option<Remark> {
        if self.fitted_to_these > 0 {
            return Some(Remark::FittedToTheSame);
        }
        let (effects, fitted) = (self.effects.clone(), !self.fitted_to.is_empty());
        (!effects.is_empty()).then_some(Remark::SimulationWith { effects, fitted })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_follows_the_verdict() {
        let file = FittedTo { path: "measurement/S01.csv".into(), sha256: String::new() };
        let of = |effects: &[&str], fitted_to: &[FittedTo], fitted_to_these| {
            let effects = effects.iter().map(|effect| (*effect).to_string()).collect();
            OriginInfo {
                made_by: String::new(),
                says: String::new(),
                effects,
                fitted_to: fitted_to.to_vec(),
                fitted_to_these,
                imported: Vec::new(),
            }
            .note()
            .map(|note| note.text().to_string())
        };
        assert_eq!(of(&[], &[], 0), None);
        assert_eq!(
            of(&["friction = 0.23"], &[], 0).as_deref(),
            Some("simulation with effect friction = 0.23")
        );
        let other = "simulation with effects a = 1 and b = 2, fitted to other measurements";
        assert_eq!(of(&["a = 1", "b = 2"], std::slice::from_ref(&file), 0).as_deref(), Some(other));
        assert_eq!(
            of(&["a = 1"], &[file], 1).as_deref(),
            Some("with a simulation fitted to the same measurements")
        );
    }
}
