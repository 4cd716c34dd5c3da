//! Percentiles of unsorted values, by the methods of Hyndman and Fan and the further methods of
//! NumPy.
//!
//! Source: Hyndman and Fan, "Sample quantiles in statistical packages", The American Statistician
//! 50 (1996) 361-365. Names, edge cases and the last digit follow `numpy.percentile`.

use std::{cmp::Ordering, fmt};

/// Rule for the value between two order statistics.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    /// Type 1.
    InvertedCdf,
    /// Type 2.
    AveragedInvertedCdf,
    /// Type 3.
    ClosestObservation,
    /// Type 4.
    InterpolatedInvertedCdf,
    /// Type 5.
    Hazen,
    /// Type 6.
    Weibull,
    /// Type 7.
    Linear,
    /// Type 8.
    MedianUnbiased,
    /// Type 9.
    NormalUnbiased,
    Lower,
    Higher,
    Midpoint,
    Nearest,
}

impl Method {
    /// Every method with NumPy's name.
    pub const NAMES: [(Self, &'static str); 13] = [
        (Self::InvertedCdf, "inverted_cdf"),
        (Self::AveragedInvertedCdf, "averaged_inverted_cdf"),
        (Self::ClosestObservation, "closest_observation"),
        (Self::InterpolatedInvertedCdf, "interpolated_inverted_cdf"),
        (Self::Hazen, "hazen"),
        (Self::Weibull, "weibull"),
        (Self::Linear, "linear"),
        (Self::MedianUnbiased, "median_unbiased"),
        (Self::NormalUnbiased, "normal_unbiased"),
        (Self::Lower, "lower"),
        (Self::Higher, "higher"),
        (Self::Midpoint, "midpoint"),
        (Self::Nearest, "nearest"),
    ];

    /// NumPy's name.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(method, _)| *method == self).map_or("", |(_, name)| name)
    }

    /// The method with this name of NumPy.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(_, known)| *known == name).map(|(method, _)| *method)
    }

    /// Position of the quantile among the order statistics of `count` values: index of the one
    /// below, from 0, and weight of the one above.
    fn position(self, count: usize, quantile: f64) -> (usize, f64) {
        let n = count as f64;
        let between =
            |alpha: f64, beta: f64| n * quantile + (alpha + quantile * (1.0 - alpha - beta)) - 1.0;
        let whole = |place: f64| (place, 0.0);
        let fraction = |place: f64| (place.floor(), place - place.floor());
        let (below, weight) = match self {
            Self::InvertedCdf => whole((n * quantile - 1.0).ceil()),
            Self::AveragedInvertedCdf => {
                let (below, rest) = fraction(n * quantile - 1.0);
                (below, if rest == 0.0 { 0.5 } else { 1.0 })
            }
            Self::ClosestObservation => {
                let (below, rest) = fraction(n * quantile - 1.5);
                // Halfway, the order statistic with even number (from 1).
                whole(if rest == 0.0 && below.rem_euclid(2.0) == 1.0 { below } else { below + 1.0 })
            }
            Self::InterpolatedInvertedCdf => fraction(between(0.0, 1.0)),
            Self::Hazen => fraction(between(0.5, 0.5)),
            Self::Weibull => fraction(between(0.0, 0.0)),
            Self::Linear => fraction((n - 1.0) * quantile),
            Self::MedianUnbiased => fraction(between(1.0 / 3.0, 1.0 / 3.0)),
            Self::NormalUnbiased => fraction(between(3.0 / 8.0, 3.0 / 8.0)),
            Self::Lower => whole(((n - 1.0) * quantile).floor()),
            Self::Higher => whole(((n - 1.0) * quantile).ceil()),
            Self::Midpoint => {
                let (below, rest) = fraction((n - 1.0) * quantile);
                (below, if rest == 0.0 { 0.0 } else { 0.5 })
            }
            Self::Nearest => whole(((n - 1.0) * quantile).round_ties_even()),
        };
        if below < 0.0 {
            (0, 0.0)
        } else if below >= n - 1.0 {
            (count - 1, 0.0)
        } else {
            (below as usize, weight)
        }
    }
}

/// One percentile of unsorted values, in time proportional to their number.
///
/// # Errors
/// No values; a value that is not finite; a percent outside 0 to 100.
pub fn percentile(values: &[f64], percent: f64, method: Method) -> Result<f64, PercentileError> {
    check(values, &[percent])?;
    Ok(near_an_end(values, percent, method)
        .unwrap_or_else(|| select(&mut values.to_vec(), percent, method)))
}

/// Several percentiles of unsorted values.
///
/// # Errors
/// As [`percentile`].
pub fn percentiles(
    values: &[f64],
    percents: &[f64],
    method: Method,
) -> Result<Vec<f64>, PercentileError> {
    check(values, percents)?;
    // Selection reads each value about three times, sorting about log2(n) times.
    if percents.len() * 3 >= values.len().ilog2() as usize {
        let mut sorted = values.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        return Ok(percents.iter().map(|&percent| of_sorted(&sorted, percent, method)).collect());
    }
    let mut copy = Vec::new();
    let mut inside = |percent: f64| {
        if copy.is_empty() {
            copy = values.to_vec();
        }
        select(&mut copy, percent, method)
    };
    let found = percents
        .iter()
        .map(|&percent| near_an_end(values, percent, method).unwrap_or_else(|| inside(percent)));
    Ok(found.collect())
}

/// Several percentiles of values that are sorted already.
///
/// # Errors
/// As [`percentile`].
pub fn percentiles_of_sorted(
    sorted: &[f64],
    percents: &[f64],
    method: Method,
) -> Result<Vec<f64>, PercentileError> {
    check(sorted, percents)?;
    Ok(percents.iter().map(|&percent| of_sorted(sorted, percent, method)).collect())
}

fn of_sorted(sorted: &[f64], percent: f64, method: Method) -> f64 {
    let (below, weight) = method.position(sorted.len(), percent / 100.0);
    blend(sorted[below], sorted[(below + 1).min(sorted.len() - 1)], weight)
}

/// Largest number of values kept in the search for a percentile near an end.
const NEAR: usize = 64;

/// A percentile among the smallest or largest values, such as the 0.15 % and 99.85 % values of a
/// record. It reads each value once, without a copy. `None` if the percentile is not near an end;
/// selection is then faster.
fn near_an_end(values: &[f64], percent: f64, method: Method) -> Option<f64> {
    let (below, weight) = method.position(values.len(), percent / 100.0);
    let both = usize::from(weight > 0.0);
    let from_top = values.len() - below;
    let most = NEAR.min(values.len() / 8);
    if below + 1 + both <= most {
        let low = smallest(values, |value| value, below + 1 + both);
        Some(blend(low[below], low[below + both], weight))
    } else if from_top <= most {
        let high = smallest(values, |value| -value, from_top);
        Some(blend(-high[from_top - 1], -high[from_top - 1 - both], weight))
    } else {
        None
    }
}

/// Values compared at once with the largest that is kept: most blocks have none below it.
const BLOCK: usize = 16;

/// The `count` smallest of the values behind `of`, sorted; there must be at least as many, and one
/// at least.
fn smallest(values: &[f64], of: impl Fn(f64) -> f64, count: usize) -> Vec<f64> {
    let (first, others) = values.split_at(count);
    let mut kept: Vec<f64> = Vec::with_capacity(count + 1);
    kept.extend(first.iter().map(|value| of(*value)));
    // Zeros of both signs are equal, as in the comparisons below.
    kept.sort_by(|a, b| a.partial_cmp(b).unwrap_or(Ordering::Equal));
    for block in others.chunks(BLOCK) {
        let last = kept[count - 1];
        if !block.iter().fold(false, |any, value| any | (of(*value) < last)) {
            continue;
        }
        for value in block.iter().map(|value| of(*value)) {
            if value < kept[count - 1] {
                kept.insert(kept.partition_point(|known| *known <= value), value);
                kept.truncate(count);
            }
        }
    }
    kept
}

fn check(values: &[f64], percents: &[f64]) -> Result<(), PercentileError> {
    if let Some(&percent) = percents.iter().find(|percent| !(0.0..=100.0).contains(*percent)) {
        return Err(PercentileError::Percent { percent });
    }
    if values.is_empty() {
        return Err(PercentileError::Empty);
    }
    // The loop checks all values without an early exit, which is faster.
    if values.iter().fold(true, |all, value| all & value.is_finite()) {
        return Ok(());
    }
    let index = values.iter().position(|value| !value.is_finite()).unwrap_or(0);
    Err(PercentileError::NotFinite { index })
}

fn select(values: &mut [f64], percent: f64, method: Method) -> f64 {
    let (below, weight) = method.position(values.len(), percent / 100.0);
    let (_, &mut lower, above) = values.select_nth_unstable_by(below, f64::total_cmp);
    let upper = if weight > 0.0 {
        above.iter().copied().min_by(f64::total_cmp).unwrap_or(lower)
    } else {
        lower
    };
    blend(lower, upper, weight)
}

/// NumPy's interpolation, from the nearer end, so that it is monotone and exact at both ends.
fn blend(lower: f64, upper: f64, weight: f64) -> f64 {
    if weight == 0.0 {
        lower
    } else if weight < 0.5 {
        lower + (upper - lower) * weight
    } else {
        upper - (upper - lower) * (1.0 - weight)
    }
}

/// Reason why there is no percentile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PercentileError {
    Empty,
    /// Index from 0.
    NotFinite {
        index: usize,
    },
    Percent {
        percent: f64,
    },
}

impl fmt::Display for PercentileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Empty => f.write_str("there are no values"),
            Self::NotFinite { index } => write!(f, "value {} is not finite", index + 1),
            Self::Percent { percent } => {
                write!(f, "a percentile must be from 0 to 100 %, this is {percent} %")
            }
        }
    }
}
