//! Linear interpolation of a signal at other points of its axis.

use std::fmt;

use super::rounded;

/// Largest number of points of a grid: 50 km in steps of a centimetre, 40 MB for each signal. A
/// step that is wrong by orders of magnitude gives an error instead of filling the memory.
const MOST_POINTS: f64 = 5e6;

/// Points `start, start + step, ...` up to and including `end`, with a tolerance of 1e-9 steps.
///
/// # Errors
/// A step that is not positive; an end before the start; too many points.
pub fn uniform_grid(start: f64, end: f64, step: f64) -> Result<Vec<f64>, ResampleError> {
    let steps = ((end - start) / step + 1e-9).floor();
    if !(step > 0.0 && (0.0..MOST_POINTS).contains(&steps)) {
        return Err(ResampleError::Grid { start, end, step });
    }
    Ok((0..=steps as usize).map(|k| (start + k as f64 * step).min(end)).collect())
}

/// The signal on a uniform grid over its whole axis: the grid and the values.
///
/// # Errors
/// As [`uniform_grid`] and [`interpolate`].
pub fn resample(
    axis: &[f64],
    signal: &[f64],
    step: f64,
) -> Result<(Vec<f64>, Vec<f64>), ResampleError> {
    check(axis, signal)?;
    let (Some(&start), Some(&end)) = (axis.first(), axis.last()) else {
        return Err(ResampleError::Empty);
    };
    let grid = uniform_grid(start, end, step)?;
    let values = interpolate(axis, signal, &grid)?;
    Ok((grid, values))
}

/// The signal at given points, in any order; fastest when they increase.
///
/// # Errors
/// An axis that does not increase strictly or differs in length from the signal; a point outside
/// the axis, as nothing is extrapolated.
pub fn interpolate(
    axis: &[f64],
    signal: &[f64],
    points: &[f64],
) -> Result<Vec<f64>, ResampleError> {
    check(axis, signal)?;
    places(axis, points)?.map(|place| place.map(|place| place.value(signal))).collect()
}

/// Points on an axis, at which several signals with this axis are interpolated.
#[derive(Debug)]
pub struct Located(Vec<BetweenSamples>);

/// A point between two samples, or on the first of them.
#[derive(Debug)]
struct BetweenSamples {
    before: usize,
    /// Distance from that sample; 0 on it.
    beyond: f64,
    /// Distance of the next sample.
    step: f64,
}

impl Located {
    /// # Errors
    /// An axis that does not increase strictly; a point outside it.
    pub fn on(axis: &[f64], points: &[f64]) -> Result<Self, ResampleError> {
        match not_increasing(axis) {
            Some(sample) => Err(ResampleError::Axis { sample }),
            None => places(axis, points)?.collect::<Result<_, _>>().map(Self),
        }
    }

    /// The values of a signal, which has a sample for each value of the axis.
    pub fn values(&self, signal: &[f64]) -> Vec<f64> {
        self.0.iter().map(|place| place.value(signal)).collect()
    }
}

impl BetweenSamples {
    fn value(&self, signal: &[f64]) -> f64 {
        let here = signal[self.before];
        if self.beyond == 0.0 {
            return here;
        }
        let slope = (signal[self.before + 1] - here) / self.step;
        here + slope * self.beyond
    }
}

/// Places of points on an axis that increases strictly.
fn places<'a>(
    axis: &'a [f64],
    points: &'a [f64],
) -> Result<impl Iterator<Item = Result<BetweenSamples, ResampleError>> + 'a, ResampleError> {
    let (first, last) = match axis {
        [] if points.is_empty() => (0.0, 0.0),
        [] => return Err(ResampleError::Empty),
        [first, ..] => (*first, axis[axis.len() - 1]),
    };
    // Index of the sample at or before the last point.
    let mut before = 0;
    Ok(points.iter().map(move |&point| {
        if !(first <= point && point <= last) {
            return Err(ResampleError::Outside { point, first, last });
        }
        let in_reach = before + 8 < axis.len() && axis[before] <= point && point < axis[before + 8];
        before = if in_reach {
            before + axis[before + 1..before + 8].iter().take_while(|&&at| at <= point).count()
        } else {
            axis.partition_point(|&at| at <= point) - 1
        };
        let step = axis.get(before + 1).map_or(1.0, |next| next - axis[before]);
        Ok(BetweenSamples { before, beyond: point - axis[before], step })
    }))
}

/// Index of the first sample that is not larger than the one before, or is NaN.
pub(super) fn not_increasing(axis: &[f64]) -> Option<usize> {
    if axis.first().is_some_and(|first| !first.is_finite()) {
        return Some(0);
    }
    axis.array_windows()
        .position(|[before, after]| !(before < after && after.is_finite()))
        .map(|index| index + 1)
}

fn check(axis: &[f64], signal: &[f64]) -> Result<(), ResampleError> {
    if axis.len() != signal.len() {
        return Err(ResampleError::Lengths { axis: axis.len(), signal: signal.len() });
    }
    match not_increasing(axis) {
        Some(sample) => Err(ResampleError::Axis { sample }),
        None => Ok(()),
    }
}

/// Reason why a signal has no values at other points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ResampleError {
    Empty,
    Lengths {
        axis: usize,
        signal: usize,
    },
    /// The axis does not increase at this sample, counted from 0.
    Axis {
        sample: usize,
    },
    Outside {
        point: f64,
        first: f64,
        last: f64,
    },
    Grid {
        start: f64,
        end: f64,
        step: f64,
    },
}

impl fmt::Display for ResampleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Empty => f.write_str("the signal has no samples"),
            Self::Lengths { axis, signal } => {
                write!(f, "the axis has {axis} samples, the signal {signal}")
            }
            Self::Axis { sample } => {
                write!(f, "the axis does not increase at sample {}", sample + 1)
            }
            Self::Outside { point, first, last } => {
                write!(
                    f,
                    "the point {} lies outside the record, {} to {}",
                    rounded(point),
                    rounded(first),
                    rounded(last)
                )
            }
            Self::Grid { start, end, step } => {
                write!(
                    f,
                    "there is no grid from {} to {} in steps of {}",
                    rounded(start),
                    rounded(end),
                    rounded(step)
                )
            }
        }
    }
}
