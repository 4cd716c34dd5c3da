//! The shape of a signal along a section, coarse enough to be kept and compared with those of all
//! other sections.

use serde::{Deserialize, Serialize};

use crate::data::WhichRecord;
use crate::metrics::statistics::{Divisor, correlation, mean, standard_deviation};

/// A section has at most so many steps: one of 250 m has steps of a metre, in which the axles of a
/// bogie are told apart.
const MOST: f64 = 256.0;
/// Steps to a standard deviation: rounding is a hundredth of the signal.
const LEVELS: f64 = 32.0;
/// Least number of steps of a comparison.
const FEWEST: usize = 16;

/// Means of a signal over steps of the axis from the start of the section.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Shape {
    /// Index of the rule that asks for it.
    pub rule: usize,
    pub channel: String,
    pub which: WhichRecord,
    /// The record in words: `measurement run1`.
    pub record: String,
    /// The steps are so many times halves of a unit of the axis, SI: 0 is 1, -1 is a half.
    step: i32,
    /// Less the mean, in 32ths of the standard deviation.
    values: Vec<i8>,
}

impl Shape {
    /// `None` for a signal that is constant, or too short.
    pub fn of(
        (rule, channel): (usize, &str),
        (which, record): (WhichRecord, String),
        (axis, values): (&[f64], &[f64]),
    ) -> Option<Self> {
        let (first, last) = (*axis.first()?, *axis.last()?);
        let apart = (last - first) / (axis.len() - 1).max(1) as f64;
        let least = ((last - first) / MOST).max(apart);
        let step = least.log2().ceil() as i32;
        let mut steps: Vec<(f64, f64)> = Vec::new();
        for (at, value) in axis.iter().zip(values) {
            let number = ((at - first) / 2.0_f64.powi(step)) as usize;
            // Also of one between two samples, which has none of its own.
            steps.resize(steps.len().max(number.min(MOST as usize) + 1), (0.0, 0.0));
            let (sum, count) = steps.last_mut()?;
            (*sum, *count) = (*sum + value, *count + 1.0);
        }
        let means: Vec<f64> = steps.iter().map(|(sum, count)| sum / count.max(1.0)).collect();
        let (middle, spread) = (mean(&means)?, standard_deviation(&means, Divisor::Population)?);
        let rounded = |value: &f64| (LEVELS * (value - middle) / spread).round() as i8;
        (spread > 0.0 && means.len() >= FEWEST).then(|| Self {
            rule,
            channel: channel.to_string(),
            which,
            record,
            step,
            values: means.iter().map(rounded).collect(),
        })
    }

    /// The correlation of both, each from the start of its section, over the shorter one.
    pub fn agreement(&self, other: &Self) -> Option<f64> {
        let step = self.step.max(other.step);
        let (a, b) = (self.at(step), other.at(step));
        let count = a.len().min(b.len());
        (count >= FEWEST).then(|| correlation(&a[..count], &b[..count])).flatten()
    }

    /// The values with longer steps.
    fn at(&self, step: i32) -> Vec<f64> {
        let together = 1_usize << (step - self.step).clamp(0, 8);
        self.values
            .chunks_exact(together)
            .map(|part| part.iter().map(|v| f64::from(*v)).sum())
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::RecordKind;

    fn shape(length: f64, samples: usize, signal: impl Fn(f64) -> f64) -> Option<Shape> {
        let axis: Vec<f64> =
            (0..samples).map(|k| 500.0 + length * k as f64 / samples as f64).collect();
        let values: Vec<f64> = axis.iter().map(|at| signal(at - 500.0)).collect();
        let which: WhichRecord = RecordKind::Measurement.into();
        Shape::of((0, "Y"), (which, "measurement".into()), (&axis, &values))
    }

    /// Of the same track in sections of other lengths and sampling; and of other tracks.
    #[test]
    fn shapes_agree_over_the_shorter_section() {
        let track = |seed: f64| move |at: f64| (at * seed).sin() + (at * 0.31 * seed + seed).cos();
        let one = shape(250.0, 1500, track(0.2)).expect("a shape");
        let longer = shape(400.0, 1600, track(0.2)).expect("a shape");
        let other = shape(250.0, 1500, track(0.37)).expect("a shape");
        let agreed = one.agreement(&longer).expect("alike");
        assert!(agreed > 0.98, "{agreed}");
        assert!(one.agreement(&other).is_some_and(|agreed| agreed.abs() < 0.4));
        assert!(shape(250.0, 1500, |_| 3.0).is_none() && shape(250.0, 10, track(0.2)).is_none());
    }
}
