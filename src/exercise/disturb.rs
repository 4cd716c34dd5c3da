//! What is added to a channel so that a value comes near its limit.

use std::f64::consts::{PI, TAU};

use crate::effects::Signals;
use crate::result::exercise::{Disturbance, Over, Shape};

/// Frequencies of added tones, Hz: quasi-static, those of a car body, of a bogie, of a wheelset.
const TONES: [f64; 5] = [0.5, 1.5, 5.0, 12.0, 40.0];

/// Peaks: each lasts this long, s, and one begins in each period, s. They hold 4 % of a record, so
/// that a percentile of 99 % sees them, and a median does not.
const PEAK: f64 = 0.2;
const PERIOD: f64 = 5.0;

/// A channel that fluctuates less than this share of its mean is quiet: its fluctuation says little
/// of the changes that a machine makes.
const QUIET: f64 = 0.05;

/// The shapes in the order in which they are tried.
pub fn shapes() -> Vec<Shape> {
    let tones = TONES.iter().map(|frequency| Shape::Tone { frequency: *frequency });
    [Shape::Level, Shape::Gain, Shape::Peaks].into_iter().chain(tones).collect()
}

/// A shape with an amplitude of 1 for a channel whose fluctuation has this rms value, in the unit
/// of the channel.
pub fn shape(of: Shape, signals: &Signals, values: &[f64], rms: f64) -> Vec<f64> {
    let mean = mean(values);
    let time = |at: usize| at as f64 / signals.rate;
    let one = |(at, value): (usize, &f64)| match of {
        Shape::Level => rms,
        Shape::Gain => value - mean,
        Shape::Peaks => {
            let since = time(at) % PERIOD;
            // The first peak does not begin with the record, where filters settle.
            let of_peak = (since - PERIOD / 2.0) / PEAK;
            let inside = (0.0..1.0).contains(&of_peak);
            if inside { rms * (PI * of_peak).sin().powi(2) } else { 0.0 }
        }
        Shape::Tone { frequency } => rms * (TAU * frequency * time(at)).sin(),
    };
    values.iter().enumerate().map(one).collect()
}

pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// The rms value of a channel about its mean; of a quiet one a share of its mean.
pub fn rms(values: &[f64]) -> f64 {
    let mean = mean(values);
    let square = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    (square / values.len().max(1) as f64).sqrt().max(QUIET * mean.abs())
}

impl Disturbance {
    /// What the shape is multiplied by in a section, by its number.
    pub fn weight(&self, section: usize) -> f64 {
        match self.over {
            Over::All => 1.0,
            Over::Alternating if section.is_multiple_of(2) => 1.0,
            Over::Alternating => -1.0,
            Over::Section { section: only } => f64::from(u8::from(section == only)),
        }
    }
}
