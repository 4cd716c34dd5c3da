//! Records as they would be with a known disturbance: what a metric makes of it is its sensitivity.

use std::ops::Range;

use crate::data::{Record, RecordKind};
use crate::metrics::disturb;
use crate::result::Reason;

/// What is done to the records of a section before a protocol sees them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trial {
    /// Nothing.
    AsRecorded,
    /// Every measured channel is disturbed.
    Disturbed(Disturbance),
    /// Every channel of both sides is twice as large: tells whether a metric is relative.
    Doubled,
    /// The measurement in the place of the simulation and the other way round: tells whether a
    /// metric treats both alike.
    Exchanged,
}

/// A disturbance of size x changes the measured samples of a section by x times the standard
/// deviation of each channel, as an rms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disturbance {
    pub kind: Kind,
    pub size: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The same amount is added to every sample.
    Offset,
    /// Every sample is multiplied by the same factor above 1.
    Gain,
    /// All channels are later by the same time: the rms is that over the channels.
    Shift,
    /// White noise is added.
    Noise,
}

impl Trial {
    /// Which record is read in place of another.
    pub fn kind(self, kind: RecordKind) -> RecordKind {
        match (self, kind) {
            (Self::Exchanged, RecordKind::Measurement) => RecordKind::Simulation,
            (Self::Exchanged, RecordKind::Simulation) => RecordKind::Measurement,
            _ => kind,
        }
    }

    /// Whether records of a kind are other than recorded.
    pub fn changes(self, kind: RecordKind) -> bool {
        match self {
            Self::AsRecorded | Self::Exchanged => false,
            Self::Disturbed(_) => kind == RecordKind::Measurement,
            Self::Doubled => kind != RecordKind::Track,
        }
    }

    /// Changes the channels of a record; `axes` are columns that records run along, which stay.
    ///
    /// # Errors
    /// No shift makes as large a change.
    pub fn apply(
        self,
        section: &str,
        record: &mut Record,
        axes: &[String],
        rows: Range<usize>,
    ) -> Result<(), Reason> {
        let channels = record.columns.iter_mut().filter(|column| !axes.contains(&column.name));
        match self {
            Self::AsRecorded | Self::Exchanged => {}
            Self::Doubled => {
                channels.for_each(|column| column.values.iter_mut().for_each(|value| *value *= 2.0))
            }
            Self::Disturbed(Disturbance { kind: Kind::Shift, size }) => {
                let mut channels: Vec<_> = channels.collect();
                let scatter: Vec<(&[f64], f64)> = channels
                    .iter()
                    .filter_map(|column| {
                        Some((
                            column.values.as_slice(),
                            disturb::deviation(&column.values[rows.clone()])?,
                        ))
                    })
                    .collect();
                if scatter.is_empty() {
                    return Ok(());
                }
                let delay = disturb::delay_of_size(&scatter, rows, size)
                    .ok_or_else(|| Reason::NoShift { section: section.into(), size })?;
                channels
                    .iter_mut()
                    .for_each(|column| column.values = disturb::delayed(&column.values, delay));
            }
            Self::Disturbed(Disturbance { kind, size }) => {
                for column in channels {
                    // A constant channel has no scatter to measure a change by.
                    let Some(deviation) = disturb::deviation(&column.values[rows.clone()]) else {
                        continue;
                    };
                    let change = size * deviation;
                    match kind {
                        Kind::Gain => {
                            let factor = 1.0
                                + change / disturb::root_mean_square(&column.values[rows.clone()]);
                            column.values.iter_mut().for_each(|value| *value *= factor);
                        }
                        Kind::Noise => {
                            let stream = disturb::stream([section, column.name.as_str()]);
                            let noise = disturb::noise(stream, column.values.len(), rows.clone());
                            column
                                .values
                                .iter_mut()
                                .zip(noise)
                                .for_each(|(value, noise)| *value += change * noise);
                        }
                        Kind::Offset | Kind::Shift => {
                            column.values.iter_mut().for_each(|value| *value += change)
                        }
                    }
                }
            }
        }
        Ok(())
    }
}
