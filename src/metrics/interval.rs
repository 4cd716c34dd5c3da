//! Confidence intervals of the mean and the standard deviation of normally distributed values, and of a share.

use super::{
    cluster::{Bounds, Mean, StandardDeviation, by_site},
    statistics::{Divisor, standard_deviation},
};

/// Confidence level usual in test reports.
pub const CONFIDENCE: f64 = 0.95;

/// Lower and upper end of a confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    pub low: f64,
    pub high: f64,
}

/// Interval of the mean of values that are independent between sites, but not within a site; see [`Mean`].
///
/// `site` is the site of each value. `None` for fewer than two sites, lists of different length, a value that is not finite, or a
/// confidence not between 0 and 1.
pub fn mean_interval(values: &[f64], site: &[usize], confidence: f64) -> Option<Interval> {
    Mean::of(&by_site(values, site).ok()?).ok()?.interval(confidence).ok()
}

/// Interval of the standard deviation, with equal tails: chi-square with G - 1 degrees of freedom for G sites. The values of one
/// site count as one value, as their dependence is not known. With one value per site, this is the usual interval.
/// [`StandardDeviation::of`] is narrower, but its coverage is below the stated confidence.
///
/// `site` and `None` as in [`mean_interval`].
pub fn standard_deviation_interval(values: &[f64], site: &[usize], confidence: f64) -> Option<Interval> {
    let value = standard_deviation(values, Divisor::Sample)?;
    let degrees = by_site(values, site).ok()?.len() as f64 - 1.0;
    StandardDeviation { value, degrees: Some(degrees) }.interval(confidence).ok()
}

/// 95 % interval of a share `good` of `all` (Wilson 1927); 0 to 1 if `all` is zero.
#[must_use]
pub fn wilson(good: u64, all: u64) -> (f64, f64) {
    /// 97.5 % quantile of the normal distribution.
    const NORMAL: f64 = 1.959_963_984_540_054;
    if all == 0 {
        return (0.0, 1.0);
    }
    let (n, p) = (all as f64, good as f64 / all as f64);
    let square = NORMAL * NORMAL;
    let center = (p + square / (2.0 * n)) / (1.0 + square / n);
    let half = NORMAL / (1.0 + square / n) * (p * (1.0 - p) / n + square / (4.0 * n * n)).sqrt();
    // At the ends, both terms cancel except for rounding.
    (if good == 0 { 0.0 } else { (center - half).max(0.0) }, if good == all { 1.0 } else { (center + half).min(1.0) })
}
