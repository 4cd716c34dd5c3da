//! Butterworth filters and transfer functions, forward and backward or in one pass, as second-order
//! sections.
//!
//! Agrees with SciPy's `butter(..., output="sos")`, `sosfiltfilt` and `sosfilt`.

mod butterworth;
mod poles;
mod section;
mod sweep;
mod transfer;

use std::fmt;

use super::rounded;
use section::Section;
pub use transfer::{Roots, TransferFunction, Warping};

/// The pass band or stop band, with the edges in Hz.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Band {
    LowPass(f64),
    HighPass(f64),
    BandPass(f64, f64),
    BandStop(f64, f64),
}

/// Direction and initial state of the filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Forward and backward: no delay, twice the attenuation. Ends are extended by an odd
    /// reflection.
    Zero,
    /// One pass, from the steady state of the first value.
    Causal,
    /// One pass, from the steady state of zero.
    CausalFromRest,
}

/// Which filter has its -3 dB points at the stated frequencies. The two differ only for
/// [`Phase::Zero`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cutoff {
    /// The filter as applied, both passes together.
    AsApplied,
    /// Each pass; both passes together are then at -6 dB there.
    PerPass,
}

/// A filter ready to run at one sampling rate.
#[derive(Clone, Debug, PartialEq)]
pub struct Filter {
    phase: Phase,
    /// Of one pass.
    gain: f64,
    sections: Vec<Section>,
    /// Number of samples by which each end is extended.
    padding: usize,
    sampling_rate: f64,
    time_constant: f64,
}

impl Filter {
    /// Butterworth filter for signals at `sampling_rate` in Hz.
    ///
    /// `order` counts the poles of a low-pass or high-pass, and the poles per edge of a band-pass
    /// or band-stop, of one pass. With [`Cutoff::AsApplied`] and [`Phase::Zero`] the pre-warped
    /// frequencies are moved so that the -3 dB points of both passes together lie at the stated
    /// ones; a band keeps its centre.
    ///
    /// # Errors
    /// An order outside 1 to 20; a frequency not between 0 and half the sampling rate; a lower edge
    /// not below the upper one; edges so close to 0 or to half the sampling rate that the sections
    /// would be unstable in double precision.
    pub fn design(
        band: Band,
        order: usize,
        sampling_rate: f64,
        phase: Phase,
        cutoff: Cutoff,
    ) -> Result<Self, DesignError> {
        let both_passes = phase == Phase::Zero && cutoff == Cutoff::AsApplied;
        let design = butterworth::design(band, order, sampling_rate, both_passes)?;
        Ok(Self::of(design, sampling_rate, phase))
    }

    /// Filter by poles and zeros for signals at `sampling_rate` in Hz. With [`Phase::Zero`], both
    /// passes use the function: its magnitude is squared, except for the gain, which is that of
    /// both passes together.
    ///
    /// # Errors
    /// Poles not above 0 Hz; more zeros than poles; a gain not above zero; a pre-warped frequency
    /// not below half the sampling rate; poles that cannot be distinguished from the unit circle in
    /// double precision.
    pub fn transfer(
        function: &TransferFunction,
        sampling_rate: f64,
        phase: Phase,
        warping: Warping,
    ) -> Result<Self, DesignError> {
        let gain = if phase == Phase::Zero { function.gain.sqrt() } else { function.gain };
        let of_one_pass = TransferFunction { gain, ..*function };
        Ok(Self::of(transfer::design(&of_one_pass, sampling_rate, warping)?, sampling_rate, phase))
    }

    fn of(design: butterworth::Design, sampling_rate: f64, phase: Phase) -> Self {
        // SciPy's rule: three times the number of taps, a first-order section having one fewer.
        let first_order =
            design.sections.iter().filter(|section| section.b2 == 0.0 && section.a2 == 0.0).count();
        let padding = if phase == Phase::Zero {
            3 * (2 * design.sections.len() + 1 - first_order)
        } else {
            0
        };
        let time_constant = design.time_constant / sampling_rate;
        Self {
            phase,
            gain: design.gain,
            sections: design.sections,
            padding,
            sampling_rate,
            time_constant,
        }
    }

    /// The filtered signal, with the same length.
    ///
    /// A sample that is not finite makes the whole result not finite; check for it before.
    ///
    /// # Errors
    /// A signal not longer than the extension of its ends.
    pub fn apply(&self, signal: &[f64]) -> Result<Vec<f64>, TooShort> {
        self.long_enough(signal)?;
        let [filtered] = self.run([signal], &mut Vec::new());
        Ok(filtered)
    }

    /// The filtered signals, identical to those of [`Self::apply`] to the last bit, but several
    /// times faster: neighbouring signals of equal length are filtered together.
    ///
    /// # Errors
    /// A signal not longer than the extension of its ends.
    pub fn apply_many(&self, signals: &[&[f64]]) -> Result<Vec<Vec<f64>>, TooShort> {
        for signal in signals {
            self.long_enough(signal)?;
        }
        let mut filtered = Vec::with_capacity(signals.len());
        let mut fours_at_work = Vec::new();
        for equal in signals.chunk_by(|left, right| left.len() == right.len()) {
            let (fours, rest) = equal.as_chunks::<4>();
            for four in fours {
                filtered.extend(self.run(*four, &mut fours_at_work));
            }
            match *rest {
                [] => {}
                [a] => filtered.extend(self.run([a], &mut Vec::new())),
                [a, b] => filtered.extend(self.run([a, b], &mut Vec::new())),
                // Four lanes take as long as three; the last signal is filtered twice.
                [a, b, c, ..] => {
                    filtered.extend(self.run([a, b, c, c], &mut fours_at_work).into_iter().take(3))
                }
            }
        }
        Ok(filtered)
    }

    /// Amplitude ratio of the filter as applied at a frequency in Hz; 1 in the pass band.
    pub fn gain(&self, frequency: f64) -> f64 {
        let angle = std::f64::consts::TAU * frequency / self.sampling_rate;
        let pass: f64 = self.gain
            * self.sections.iter().map(|section| section.magnitude(angle)).product::<f64>();
        if self.phase == Phase::Zero { pass * pass } else { pass }
    }

    /// Time, in s, in which the slowest part of a transient falls to 1/e, from the pole nearest to
    /// the unit circle.
    pub fn time_constant(&self) -> f64 {
        self.time_constant
    }

    /// Minimum number of samples of a signal.
    pub fn samples_needed(&self) -> usize {
        self.padding + 1
    }

    /// The sections of one pass as rows `[b0, b1, b2, 1, a1, a2]`, the gain in the first, as SciPy
    /// gives them.
    pub fn sections(&self) -> Vec<[f64; 6]> {
        let mut gain = self.gain;
        self.sections
            .iter()
            .map(|section| {
                let row = [gain, gain * section.b1, gain * section.b2, 1.0, section.a1, section.a2];
                gain = 1.0;
                row
            })
            .collect()
    }

    fn long_enough(&self, signal: &[f64]) -> Result<(), TooShort> {
        let needed = self.samples_needed();
        if signal.len() < needed { Err(TooShort { samples: signal.len(), needed }) } else { Ok(()) }
    }
}

/// Reason why a filter cannot be designed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DesignError {
    Order {
        order: usize,
    },
    SamplingRate {
        sampling_rate: f64,
    },
    /// In Hz.
    Frequency {
        frequency: f64,
        sampling_rate: f64,
    },
    /// In Hz.
    Edges {
        low: f64,
        high: f64,
    },
    /// The poles cannot be distinguished from the unit circle in double precision.
    Degenerate {
        order: usize,
        sampling_rate: f64,
    },
}

impl fmt::Display for DesignError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Order { order } => write!(
                f,
                "the order of a filter must be from 1 to {}, this is {order}",
                butterworth::HIGHEST_ORDER
            ),
            Self::SamplingRate { sampling_rate } => {
                write!(f, "the sampling rate {sampling_rate} Hz is not a positive number")
            }
            Self::Frequency { frequency, sampling_rate } => write!(
                f,
                "the filter's frequency {frequency} Hz does not lie between 0 and half the sampling rate, {} Hz",
                rounded(sampling_rate / 2.0)
            ),
            Self::Edges { low, high } => {
                write!(f, "the band's lower edge {low} Hz is not below its upper edge {high} Hz")
            }
            Self::Degenerate { order, sampling_rate } => {
                write!(
                    f,
                    "a filter of order {order} with these frequencies cannot be computed at a sampling rate of {sampling_rate} Hz"
                )
            }
        }
    }
}

/// A signal too short to be filtered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooShort {
    pub samples: usize,
    pub needed: usize,
}

impl fmt::Display for TooShort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the signal has {} samples, the filter needs {}", self.samples, self.needed)
    }
}
