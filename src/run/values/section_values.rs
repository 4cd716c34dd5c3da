//! What the evaluation of one section gives.

use serde::{Deserialize, Serialize};

use super::print::Print;
use super::row::Row;
use super::shifts::Offset;
use crate::problem::Problem;
use crate::result::{CheckResult, FileHash, Finding, Reason};
use crate::run::sections::Extent;

/// Results of one section.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct SectionValues {
    /// The rows of the section for each quantity; empty where the position was not recorded or the
    /// quantity excludes the section. A file of values has them as its rows.
    #[serde(skip)]
    pub rows: Vec<Vec<Row>>,
    /// Quantities that cannot be evaluated in this section, with the signal and the reason.
    pub impossible: Vec<(usize, Reason)>,
    pub checks: Vec<CheckResult>,
    /// Plausibility findings within this section.
    pub findings: Vec<Finding>,
    /// Marks of the signals that are compared with others to find copies.
    pub prints: Vec<Print>,
    pub files: Vec<FileHash>,
    /// The measured range of a whole record.
    pub extent: Option<Extent>,
    /// Record beyond the section, in s, where it is too short for a slow filter to settle.
    pub short_margin: Option<f64>,
    /// Shift of the measurement against the simulation, where it was requested.
    pub offset: Option<Offset>,
    pub fault: Option<Reason>,
    pub problems: Vec<Problem>,
}
