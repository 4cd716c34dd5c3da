//! Shifts of the measurement against the simulation along the axis.

use serde::{Deserialize, Serialize};

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
