//! One section with its records.

use super::increments::Increments;
use super::layout::{Piece, Spectrum};
use super::scatter::Scatter;
use crate::effects::Signals;
use crate::simulate::Section;

/// One section with its records.
#[derive(Debug)]
pub struct Observed {
    pub section: Section,
    /// The campaign's simulation, and the measurement.
    pub simulated: Signals,
    pub measured: Signals,
    /// Spectra of the simulated channels of the layout.
    pub references: Vec<Option<Spectrum>>,
    /// Scatter of the channels of the layout.
    pub scatter: Vec<Scatter>,
    /// For the comparison sample by sample, by channel of the layout.
    pub increments: Vec<Option<Increments>>,
    /// Whether it repeats an earlier section: it adds no information on the simulation.
    pub again: bool,
}

/// The part of a channel inside its section.
pub fn piece(signals: &Signals, name: &str, section: &Section) -> Option<Piece> {
    let channel = signals.channel(name)?;
    let from = signals.axis.partition_point(|x| *x < section.start);
    let to = signals.axis.partition_point(|x| *x <= section.end);
    if to < from + 16 {
        return None;
    }
    let step = (signals.axis[to - 1] - signals.axis[from]) / (to - from - 1) as f64;
    Some(Piece { values: channel.values[from..to].to_vec(), rate: signals.rate, step })
}
