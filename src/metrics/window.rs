//! Mean and rms over a window that slides along an axis, in length or time.

use std::fmt;
use std::ops::Range;

use super::{resample::not_increasing, rounded, sum::RunningSums};

/// A sample within this distance of the edge of a window, in units of the axis, counts as on it.
const ON_THE_EDGE: f64 = 1e-6;
/// A last window that ends up to this share of a step beyond the section is used.
const LAST_STEP: f64 = 1e-9;
/// Largest number of windows. A step that is wrong by orders of magnitude gives an error instead of
/// filling the memory.
const MOST_WINDOWS: f64 = 1e8;

/// The value of each window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Mean,
    Rms,
}

/// Treatment of the ends of a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// The samples with `a <= x < a + width`, each with the same weight.
    Samples,
    /// The integral of the linearly interpolated signal from `a` to `a + width`.
    Integral,
}

/// A sliding window: `width` and `step` in units of the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sliding {
    pub width: f64,
    pub step: f64,
    pub kind: Kind,
    pub ends: Ends,
    /// Whether a section shorter than the window is one window by itself.
    pub short_sections: bool,
}

impl Sliding {
    /// Start points of the windows: `start, start + step, ...` while the window is inside the
    /// section `start..=end`.
    ///
    /// # Errors
    /// A width or step that is not positive; a section shorter than one window; too many windows.
    pub fn starts(&self, start: f64, end: f64) -> Result<Vec<f64>, SlidingError> {
        let Self { width, step, .. } = *self;
        if !(width > 0.0 && step > 0.0 && width.is_finite() && step.is_finite()) {
            return Err(SlidingError::Window { width, step });
        }
        if !(start.is_finite() && end.is_finite()) {
            return Err(SlidingError::Section { start, end });
        }
        let steps = ((end - start - width) / step + LAST_STEP).floor();
        if steps < 0.0 && self.short_sections && end > start {
            return Ok(vec![start]);
        }
        if steps < 0.0 {
            return Err(SlidingError::SectionTooShort { length: end - start, width });
        }
        if steps >= MOST_WINDOWS {
            return Err(SlidingError::Window { width, step });
        }
        Ok((0..=steps as usize).map(|k| start + step * k as f64).collect())
    }

    /// One value per window, in the order of [`Self::starts`].
    ///
    /// The record must reach both ends of the section, for [`Ends::Samples`] to within one sampling
    /// distance, so that a record cut to the section is sufficient.
    ///
    /// # Errors
    /// As [`Self::starts`]; an axis that does not increase strictly near the section, or differs in
    /// length from the signal; a record that does not reach the ends of the section; a window
    /// without samples; a value that is not finite.
    pub fn over(
        &self,
        axis: &[f64],
        signal: &[f64],
        start: f64,
        end: f64,
    ) -> Result<Vec<f64>, SlidingError> {
        let starts = self.starts(start, end)?;
        if axis.len() != signal.len() {
            return Err(SlidingError::Lengths { axis: axis.len(), signal: signal.len() });
        }
        let near = self.near(axis, start, end);
        let whole = axis;
        let (axis, signal, before) = (&axis[near.clone()], &signal[near.clone()], near.start);
        if let Some(sample) = not_increasing(axis) {
            return Err(SlidingError::Axis { sample: before + sample });
        }
        let [first, second, ..] = *axis else {
            return Err(SlidingError::TooFewSamples { samples: axis.len() });
        };
        let (before_last, last) = (axis[axis.len() - 2], axis[axis.len() - 1]);
        let (ahead, behind) = match self.ends {
            Ends::Samples => (second - first, last - before_last),
            Ends::Integral => (0.0, 0.0),
        };
        if first > start + ahead + ON_THE_EDGE || last < end - behind - ON_THE_EDGE {
            return Err(SlidingError::Record {
                first: whole[0],
                last: whole[whole.len() - 1],
                start,
                end,
            });
        }
        let fitted = Self { width: self.width_in(start, end), ..*self };
        let averages = match self.ends {
            Ends::Samples => fitted.of_samples(axis, signal, &starts)?,
            Ends::Integral => fitted.of_integral(axis, signal, &starts),
        };
        match averages.iter().zip(&starts).find(|(value, _)| !value.is_finite()) {
            Some((_, &from)) => Err(SlidingError::NotFinite { from }),
            None => Ok(averages),
        }
    }

    /// The samples that windows of the section may use, with two more on each side where there are
    /// so many; all if these are fewer than two.
    fn near(&self, axis: &[f64], start: f64, end: f64) -> Range<usize> {
        let from = axis.partition_point(|&x| x < start - ON_THE_EDGE).saturating_sub(2);
        let to = axis
            .partition_point(|&x| x <= end + ON_THE_EDGE + LAST_STEP * self.step)
            .saturating_add(2)
            .min(axis.len());
        if from + 2 <= to { from..to } else { 0..axis.len() }
    }

    /// The width of the windows of a section: its length where it is shorter and is taken all the
    /// same, with the sample at its end.
    fn width_in(&self, start: f64, end: f64) -> f64 {
        let length = end - start;
        match self.ends {
            _ if !self.short_sections || length >= self.width - LAST_STEP * self.step => self.width,
            Ends::Samples => length + 2.0 * ON_THE_EDGE,
            Ends::Integral => length,
        }
    }

    fn of_samples(
        &self,
        axis: &[f64],
        signal: &[f64],
        starts: &[f64],
    ) -> Result<Vec<f64>, SlidingError> {
        let sums = RunningSums::new(signal.iter().map(|&value| self.power(value)));
        let first_at = |point: f64| axis.partition_point(|&at| at < point);
        starts
            .iter()
            .map(|&from| {
                let first = first_at(from - ON_THE_EDGE);
                let beyond = first_at(from + self.width - ON_THE_EDGE);
                if beyond == first {
                    return Err(SlidingError::Empty { from, width: self.width });
                }
                Ok(self.root(sums.between(first, beyond) / (beyond - first) as f64))
            })
            .collect()
    }

    fn of_integral(&self, axis: &[f64], signal: &[f64], starts: &[f64]) -> Vec<f64> {
        let pieces = axis.array_windows().zip(signal.array_windows());
        let sums = RunningSums::new(pieces.map(|([a, b], &[x, y])| self.integral(b - a, x, y)));
        // The sample before a point, and the integral from there to the point.
        let within = |point: f64| {
            let beyond = axis.partition_point(|&at| at <= point);
            let piece = beyond.saturating_sub(1).min(axis.len() - 2);
            let along = point - axis[piece];
            let slope = (signal[piece + 1] - signal[piece]) / (axis[piece + 1] - axis[piece]);
            (piece, self.integral(along, signal[piece], signal[piece] + slope * along))
        };
        starts
            .iter()
            .map(|&from| {
                let (first, before) = within(from);
                let (last, after) = within(from + self.width);
                self.root((sums.between(first, last) + (after - before)) / self.width)
            })
            .collect()
    }

    /// Integral over an interval of this length in which the signal is linear from `x` to `y`.
    fn integral(&self, length: f64, x: f64, y: f64) -> f64 {
        match self.kind {
            Kind::Mean => 0.5 * length * (x + y),
            Kind::Rms => length / 3.0 * (x * x + x * y + y * y),
        }
    }

    fn power(&self, value: f64) -> f64 {
        match self.kind {
            Kind::Mean => value,
            Kind::Rms => value * value,
        }
    }

    fn root(&self, average: f64) -> f64 {
        match self.kind {
            Kind::Mean => average,
            // For a window of zeros, rounding may give a small negative number.
            Kind::Rms => average.clamp(0.0, f64::INFINITY).sqrt(),
        }
    }
}

/// Reason why there are no sliding values. Places are in units of the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SlidingError {
    Window {
        width: f64,
        step: f64,
    },
    Section {
        start: f64,
        end: f64,
    },
    SectionTooShort {
        length: f64,
        width: f64,
    },
    Lengths {
        axis: usize,
        signal: usize,
    },
    /// The axis does not increase at this sample, counted from 0.
    Axis {
        sample: usize,
    },
    TooFewSamples {
        samples: usize,
    },
    /// The record does not reach the ends of the section.
    Record {
        first: f64,
        last: f64,
        start: f64,
        end: f64,
    },
    Empty {
        from: f64,
        width: f64,
    },
    NotFinite {
        from: f64,
    },
}

impl SlidingError {
    /// The message, with rounded numbers in the unit of the axis.
    pub fn in_words(&self, unit: &str) -> String {
        let shown = |value: f64| format!("{} {unit}", rounded(value)).trim_end().to_string();
        match *self {
            Self::Window { width, step } => format!(
                "a window cannot have a width of {} and steps of {}",
                shown(width),
                shown(step)
            ),
            Self::Section { start, end } => {
                format!("a section from {} to {} has no length", shown(start), shown(end))
            }
            Self::SectionTooShort { length, width } => {
                format!(
                    "the section is {} long, shorter than one window of {}",
                    shown(length),
                    shown(width)
                )
            }
            Self::Lengths { axis, signal } => {
                format!("the axis has {axis} samples, the signal {signal}")
            }
            Self::Axis { sample } => format!("the axis does not increase at sample {}", sample + 1),
            Self::TooFewSamples { samples } => {
                format!("the record has {samples} samples, fewer than two")
            }
            Self::Record { first, last, start, end } => {
                let (record, section) = ((shown(first), shown(last)), (shown(start), shown(end)));
                format!(
                    "the record from {} to {} does not cover the section from {} to {}",
                    record.0, record.1, section.0, section.1
                )
            }
            Self::Empty { from, width } => {
                format!("the window from {} to {} has no sample", shown(from), shown(from + width))
            }
            Self::NotFinite { from } => {
                format!("the window from {} has a value that is not finite", shown(from))
            }
        }
    }
}

impl fmt::Display for SlidingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.in_words(""))
    }
}
