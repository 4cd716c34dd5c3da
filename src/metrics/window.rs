//! Values of a window that slides along an axis, in length or time.

use std::{collections::VecDeque, fmt, ops::Range};

use super::{resample::not_increasing, rounded, sum::RunningSums};

/// A sample within this distance of the edge of a window, in units of the axis, counts as on it.
const ON_THE_EDGE: f64 = 1e-6;
/// A last window that ends up to this share of a step beyond the section is used.
const LAST_STEP: f64 = 1e-9;
/// Largest number of windows. A step that is wrong by orders of magnitude gives an error instead of
/// filling the memory.
const MOST_WINDOWS: f64 = 1e8;

/// The value of each window.
#[derive(Clone, Copy)]
pub enum Kind<'a> {
    /// From running sums: one addition for each sample, however wide the window is.
    Mean,
    Rms,
    /// A function of the smallest and the largest sample, from queues: each sample enters and
    /// leaves once.
    Extremes(fn(f64, f64) -> f64),
    /// Any function of the axis and the samples of a window; `None` where it is not defined. Each
    /// window is read again.
    Reduced(&'a Reduce<'a>),
}

type Reduce<'a> = dyn Fn(&[f64], &[f64]) -> Option<f64> + Sync + 'a;

impl fmt::Debug for Kind<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Mean => "Mean",
            Self::Rms => "Rms",
            Self::Extremes(_) => "Extremes",
            Self::Reduced(_) => "Reduced",
        })
    }
}

/// Treatment of the ends of a window. Only mean and rms have an integral; all others are of the
/// samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// The samples with `a <= x < a + width`, each with the same weight.
    Samples,
    /// The integral of the linearly interpolated signal from `a` to `a + width`.
    Integral,
}

/// A sliding window: `width` and `step` in units of the axis.
#[derive(Clone, Copy, Debug)]
pub struct Sliding<'a> {
    pub width: f64,
    /// `None`: a window begins at every sample.
    pub step: Option<f64>,
    pub kind: Kind<'a>,
    pub ends: Ends,
    /// Whether a section shorter than the window is one window by itself.
    pub short_sections: bool,
}

impl Sliding<'_> {
    /// Start points of the windows: `start, start + step, ...`, or every sample from the start on,
    /// while the window is inside the section `start..=end`.
    ///
    /// # Errors
    /// A width or step that is not positive; a section shorter than one window; too many windows.
    pub fn starts(&self, axis: &[f64], start: f64, end: f64) -> Result<Vec<f64>, SlidingError> {
        let (width, step) = (self.width, self.least_step());
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
        if self.step.is_some() {
            return Ok((0..=steps as usize).map(|k| start + step * k as f64).collect());
        }
        let first = axis.partition_point(|&x| x < start - ON_THE_EDGE);
        let inside = |x: &f64| x + width <= end + LAST_STEP * step;
        let mut starts: Vec<f64> = axis[first..].iter().copied().take_while(inside).collect();
        // The section is as long as the window, and begins between two samples.
        if starts.is_empty() {
            starts.push(start);
        }
        Ok(starts)
    }

    /// The step, or the width where windows begin at every sample.
    fn least_step(&self) -> f64 {
        self.step.unwrap_or(self.width)
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
        let starts = self.starts(axis, start, end)?;
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
        let integral = self.of_sums() && self.ends == Ends::Integral;
        let (ahead, behind) =
            if integral { (0.0, 0.0) } else { (second - first, last - before_last) };
        if first > start + ahead + ON_THE_EDGE || last < end - behind - ON_THE_EDGE {
            return Err(SlidingError::Record {
                first: whole[0],
                last: whole[whole.len() - 1],
                start,
                end,
            });
        }
        let fitted = Self { width: self.width_in(start, end), ..*self };
        let values = if integral {
            fitted.of_integral(axis, signal, &starts)
        } else {
            fitted.of_samples(axis, signal, &starts)?
        };
        match values.iter().zip(&starts).find(|(value, _)| !value.is_finite()) {
            Some((_, &from)) => Err(SlidingError::NotFinite { from }),
            None => Ok(values),
        }
    }

    fn of_sums(&self) -> bool {
        matches!(self.kind, Kind::Mean | Kind::Rms)
    }

    /// The samples that windows of the section may use, with two more on each side where there are
    /// so many; all if these are fewer than two.
    fn near(&self, axis: &[f64], start: f64, end: f64) -> Range<usize> {
        let from = axis.partition_point(|&x| x < start - ON_THE_EDGE).saturating_sub(2);
        let to = axis
            .partition_point(|&x| x <= end + ON_THE_EDGE + LAST_STEP * self.least_step())
            .saturating_add(2)
            .min(axis.len());
        if from + 2 <= to { from..to } else { 0..axis.len() }
    }

    /// The width of the windows of a section: its length where it is shorter and is taken all the
    /// same, with the sample at its end.
    fn width_in(&self, start: f64, end: f64) -> f64 {
        let length = end - start;
        match self.ends {
            _ if !self.short_sections || length >= self.width - LAST_STEP * self.least_step() => {
                self.width
            }
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
        let first_at = |point: f64| axis.partition_point(|&at| at < point);
        let window = |&from: &f64| {
            let window = first_at(from - ON_THE_EDGE)..first_at(from + self.width - ON_THE_EDGE);
            if window.is_empty() {
                return Err(SlidingError::Empty { from, width: self.width });
            }
            Ok(window)
        };
        let windows: Vec<Range<usize>> = starts.iter().map(window).collect::<Result<_, _>>()?;
        match self.kind {
            Kind::Mean | Kind::Rms => {
                let sums = RunningSums::new(signal.iter().map(|&value| self.power(value)));
                let mean = |window: &Range<usize>| {
                    self.root(sums.between(window.start, window.end) / window.len() as f64)
                };
                Ok(windows.iter().map(mean).collect())
            }
            Kind::Extremes(of) => Ok(extremes(signal, &windows)
                .into_iter()
                .map(|(low, high)| of(low, high))
                .collect()),
            Kind::Reduced(of) => {
                let reduced = |(window, &from): (Range<usize>, &f64)| {
                    let samples = window.len();
                    of(&axis[window.clone()], &signal[window])
                        .ok_or(SlidingError::Undefined { from, samples })
                };
                windows.into_iter().zip(starts).map(reduced).collect()
            }
        }
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
            Kind::Rms => length / 3.0 * (x * x + x * y + y * y),
            _ => 0.5 * length * (x + y),
        }
    }

    fn power(&self, value: f64) -> f64 {
        match self.kind {
            Kind::Rms => value * value,
            _ => value,
        }
    }

    fn root(&self, average: f64) -> f64 {
        match self.kind {
            // For a window of zeros, rounding may give a small negative number.
            Kind::Rms => average.clamp(0.0, f64::INFINITY).sqrt(),
            _ => average,
        }
    }
}

/// The smallest and the largest sample of each window; not a number where one is not finite. The
/// windows are in order. A queue holds the samples of the window that no later one exceeds.
fn extremes(signal: &[f64], windows: &[Range<usize>]) -> Vec<(f64, f64)> {
    let mut queues = [VecDeque::new(), VecDeque::new()];
    let mut next = 0;
    let mut ends = Vec::with_capacity(windows.len());
    for window in windows {
        let new = next.max(window.start)..window.end;
        for (at, sample) in new.clone().zip(signal.get(new).unwrap_or_default()) {
            let value = if sample.is_finite() { *sample } else { f64::NAN };
            for (queue, value) in queues.iter_mut().zip([value, -value]) {
                // What is not a number stays until it leaves the window.
                while queue.back().is_some_and(|&(_, back): &(usize, f64)| {
                    !back.is_nan() && (back >= value || value.is_nan())
                }) {
                    queue.pop_back();
                }
                queue.push_back((at, value));
            }
        }
        next = next.max(window.end);
        let [low, high] = queues.each_mut().map(|queue| {
            while queue.front().is_some_and(|&(at, _)| at < window.start) {
                queue.pop_front();
            }
            queue.front().map_or(f64::NAN, |&(_, value)| value)
        });
        ends.push((low, -high));
    }
    ends
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
    /// The value is not defined for so few samples, or for samples without scatter.
    Undefined {
        from: f64,
        samples: usize,
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
            Self::Undefined { from, samples } => {
                let from = shown(from);
                format!("the window from {from} has no such value, with {samples} samples")
            }
        }
    }
}

impl fmt::Display for SlidingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.in_words(""))
    }
}
