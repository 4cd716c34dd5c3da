//! A row of the table of values.

use crate::result::RecordName;

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
