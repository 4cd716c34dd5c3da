//! The values of one section: from the nodes of its records to rows.
//!
//! | file | content |
//! |---|---|
//! | `shape` | a signal in coarse steps, which is compared with those of other sections |
//! | `print` | marks of a signal, by which copies are found |
//! | `common` | both sides at common points |
//! | `one_record` | one record of a section, and whether it is long enough for slow filters |
//! | `sides` | the records of a section; values, differences and metrics of them |
//! | `synchronisation` | the shift of a section, estimated from its signals |

mod common;
mod one_record;
pub mod print;
mod shape;
mod sides;
pub mod synchronisation;

use serde::{Deserialize, Serialize};

use crate::result::CheckResult;
use crate::run::{prelude::*, sections::Extent};

pub use common::Meetings;
pub use one_record::{NodeValues, RecordOfSide, margin_note};
pub use print::Print;
pub use shape::Shape;
pub use sides::{Original, Sides, Two};

/// One value of a section.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Index into the quantity's positions.
    pub position: usize,
    /// Index into the quantity's values, of which several may apply.
    pub which: usize,
    /// The record, where the campaign has several of a side.
    pub record: Option<RecordName>,
    /// The values compared, where rows compare numbers, SI.
    pub simulated: Option<f64>,
    pub measured: Option<f64>,
    /// The value that estimates use, SI: a difference, a metric, or the value of one record.
    pub value: f64,
    /// Number of samples or windows.
    pub samples: usize,
}

impl Row {
    /// Of one record, or of a metric of two.
    pub const fn single(
        position: usize,
        which: usize,
        record: Option<RecordName>,
        (value, samples): (f64, usize),
    ) -> Self {
        Self { position, which, record, simulated: None, measured: None, value, samples }
    }
}

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
    /// Signals that are compared with those of other channels and sections.
    pub shapes: Vec<Shape>,
    /// What requirements of all sections together need.
    pub pooled: Vec<Pooled>,
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

/// The numbers that a requirement of all sections together compares, in one section.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pooled {
    /// Index of the rule, of the position of its signal, and of the comparison.
    pub of: [usize; 3],
    /// The record, or both where there are several, in words.
    pub record: Option<String>,
    /// SI, as the tolerance; 0 where there is none.
    pub found: f64,
    pub expected: f64,
    pub room: f64,
}

/// The shifts at which the measurement is evaluated.
#[derive(Clone, Copy, Debug)]
pub struct Shifts<'a> {
    /// Added to the measurement's axis before sections are cut, SI.
    pub offsets: &'a [f64],
    /// Largest shift of the search, where the shift of each section is to be estimated, SI.
    pub farthest: Option<f64>,
    /// Whether the estimated shift is added as well.
    pub correct: bool,
}

impl Shifts<'_> {
    /// The records without a shift.
    pub const NONE: Shifts<'static> = Shifts { offsets: &[0.0], farthest: None, correct: false };

    pub fn plain(&self) -> bool {
        self.offsets == [0.0] && self.farthest.is_none()
    }
}

/// The shift that aligns a section's measurement with its simulation, in SI of the axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Offset {
    pub shift: f64,
    /// 95 % interval.
    pub low: f64,
    pub high: f64,
    /// Correlation of both sides at that shift, over all signals.
    pub correlation: f64,
}
