//! Statistics of values, and regression and correlation of two signals.
//!
//! `None` where the number is not defined: too few values, a value that is not finite, a division
//! by zero.

use super::{
    percentile::{Method, percentiles},
    sum::{sum, sum_of, sum_of_pairs},
};

/// Divisor of a sum of squares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Divisor {
    /// n - 1: the values are a sample.
    Sample,
    /// n: the values are the whole population.
    Population,
}

/// Arithmetic mean.
pub fn mean(values: &[f64]) -> Option<f64> {
    finite(sum(values) / count(values)?)
}

/// Variance, about the mean, in two passes.
pub fn variance(values: &[f64], divisor: Divisor) -> Option<f64> {
    let n = count(values)?;
    let degrees = match divisor {
        Divisor::Sample => n - 1.0,
        Divisor::Population => n,
    };
    if degrees < 1.0 {
        return None;
    }
    if is_constant(values) {
        return Some(0.0);
    }
    let mean = mean(values)?;
    let squares = sum_of(values, |value| (value - mean) * (value - mean));
    // Corrects for the rounding error of the mean.
    let off = sum_of(values, |value| value - mean);
    // Unlike `max`, `clamp` keeps what is not a number: the squares of large values overflow.
    finite((squares - off * off / n).clamp(0.0, f64::INFINITY) / degrees)
}

/// Standard deviation.
pub fn standard_deviation(values: &[f64], divisor: Divisor) -> Option<f64> {
    variance(values, divisor).map(f64::sqrt)
}

/// Root mean square; the mean is not removed.
pub fn rms(values: &[f64]) -> Option<f64> {
    finite((sum_of(values, |value| value * value) / count(values)?).sqrt())
}

/// Median: the middle value, or the mean of the two middle ones.
pub fn median(values: &[f64]) -> Option<f64> {
    percentiles(values, &[50.0], Method::Linear).ok()?.first().copied()
}

/// Smallest value.
pub fn minimum(values: &[f64]) -> Option<f64> {
    extremes(values).map(|(least, _)| least)
}

/// Largest value.
pub fn maximum(values: &[f64]) -> Option<f64> {
    extremes(values).map(|(_, greatest)| greatest)
}

/// Largest magnitude.
pub fn peak_magnitude(values: &[f64]) -> Option<f64> {
    extremes(values).map(|(least, greatest)| greatest.abs().max(least.abs()))
}

/// The least and the largest value; without values, the ends of an empty range.
pub fn ends(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let empty = (f64::INFINITY, f64::NEG_INFINITY);
    values.into_iter().fold(empty, |(low, high), value| (low.min(value), high.max(value)))
}

/// Largest minus smallest value.
pub fn range(values: &[f64]) -> Option<f64> {
    finite(extremes(values).map(|(least, greatest)| greatest - least)?)
}

/// A straight line fitted to points by least squares in y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    pub slope: f64,
    pub intercept: f64,
}

/// Regression of y on x. `None` for fewer than two points, signals of different length, or x
/// without scatter.
pub fn regression(x: &[f64], y: &[f64]) -> Option<Line> {
    let moments = Products::of(x, y)?;
    if moments.xx == 0.0 {
        return None;
    }
    let slope = finite(moments.xy / moments.xx)?;
    Some(Line { slope, intercept: finite(moments.mean_y - slope * moments.mean_x)? })
}

/// Root mean square about the line of least squares of y on x. `None` for fewer than three points,
/// through which no line need go, and where there is no line.
pub fn rms_about_trend(x: &[f64], y: &[f64]) -> Option<f64> {
    let moments = Products::of(x, y)?;
    if x.len() < 3 || moments.xx == 0.0 {
        return None;
    }
    let slope = moments.xy / moments.xx;
    // From the residuals: a difference of sums would lose the digits of a small scatter.
    let residual = |x, y| (y - moments.mean_y) - slope * (x - moments.mean_x);
    let squares = sum_of_pairs(x, y, |x, y| residual(x, y) * residual(x, y));
    finite((squares / count(y)?).sqrt())
}

/// Pearson's correlation, in [-1, 1]. `None` for fewer than two points, signals of different
/// length, or one of them without scatter.
pub fn correlation(x: &[f64], y: &[f64]) -> Option<f64> {
    let moments = Products::of(x, y)?;
    if moments.xx == 0.0 || moments.yy == 0.0 {
        return None;
    }
    // Separate roots, as the product of both sums of squares may overflow.
    finite((moments.xy / moments.xx.sqrt() / moments.yy.sqrt()).clamp(-1.0, 1.0))
}

/// Sums of squares and products about the means.
struct Products {
    mean_x: f64,
    mean_y: f64,
    xx: f64,
    yy: f64,
    xy: f64,
}

impl Products {
    fn of(x: &[f64], y: &[f64]) -> Option<Self> {
        if x.len() != y.len() || x.len() < 2 {
            return None;
        }
        let (mean_x, mean_y) = (mean(x)?, mean(y)?);
        // A constant signal can differ from its rounded mean, but has no scatter.
        let squares = |values: &[f64], mean: f64| {
            if is_constant(values) {
                0.0
            } else {
                sum_of(values, |value| (value - mean) * (value - mean))
            }
        };
        let xy = sum_of_pairs(x, y, |x, y| (x - mean_x) * (y - mean_y));
        Some(Self { mean_x, mean_y, xx: squares(x, mean_x), yy: squares(y, mean_y), xy })
    }
}

pub(super) fn is_constant(values: &[f64]) -> bool {
    values.first().is_some_and(|first| values.iter().all(|value| value == first))
}

fn extremes(values: &[f64]) -> Option<(f64, f64)> {
    let first = *values.first()?;
    // Comparisons with NaN are false and would not find it.
    if !values.iter().all(|value| value.is_finite()) {
        return None;
    }
    Some(
        values.iter().fold((first, first), |(least, greatest), &value| {
            (least.min(value), greatest.max(value))
        }),
    )
}

fn count(values: &[f64]) -> Option<f64> {
    if values.is_empty() { None } else { Some(values.len() as f64) }
}

pub(super) fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}
