//! What sections cover, and wanted operation inside and outside of it.

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Reason, RulePlace, told};

/// A domain of the protocol, of the sections of one group.
///
/// Distances are Euclidean, with every coordinate divided by its range over the sections of the
/// group.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DomainResult {
    /// Name of the domain in the protocol.
    pub domain: String,
    pub title: String,
    /// What its sections have in common, by section column; empty if sections are not told apart.
    pub group: IndexMap<String, String>,
    /// The same in words: `State laden`, or `all`.
    pub scope: String,
    pub coordinates: Vec<CoordinateRange>,
    /// The sections used that have all coordinates.
    pub sections: Vec<DomainSection>,
    /// Sections used without a value of some coordinate.
    pub left_out: Vec<String>,
    /// Why there is no hull.
    #[serde(flatten, with = "told::reason")]
    #[schemars(with = "told::NoneOrReason<Reason>")]
    pub reason: Option<Reason>,
    /// Wanted operation of the group.
    pub points: Vec<WantedPoint>,
    /// Consequence of a point outside.
    pub otherwise: super::Consequence,
    pub clause: Option<String>,
    pub source: Option<String>,
    pub notes: Vec<String>,
    /// Place of its definition in the protocol.
    pub rule: RulePlace,
}

/// Range of a coordinate over the sections of a group; no numbers without sections.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CoordinateRange {
    pub name: String,
    pub unit: String,
    pub low: Option<f64>,
    pub high: Option<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DomainSection {
    pub section: String,
    /// In the order of the coordinates, in their units.
    pub values: Vec<f64>,
    /// Whether it is a corner of the hull; never without a hull.
    pub corner: bool,
}

/// A point of wanted operation. Lists are in the order of the coordinates, in their units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WantedPoint {
    pub point: String,
    pub values: Vec<f64>,
    /// `None` without a hull.
    pub inside: Option<bool>,
    /// From the hull, in ranges of the coordinates; 0 inside.
    pub distance: Option<f64>,
    /// The nearest point of the hull.
    pub nearest: Option<Vec<f64>>,
    /// The point less the nearest point of the hull.
    pub outside_by: Option<Vec<f64>>,
    /// How far each value lies beyond the range of the sections, without sign; 0 within it. `None`
    /// without sections.
    pub beyond_range: Option<Vec<f64>>,
    pub nearest_section: Option<String>,
    /// From the nearest section, in ranges of the coordinates.
    pub section_distance: Option<f64>,
}
