//! Confidence intervals of the mean and the standard deviation of normally distributed values, and of a share.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::{
    statistics::{Divisor, mean, standard_deviation},
    student::student_quantile,
    sum::{sum, sum_of},
};

/// The confidence usual in test reports.
pub const CONFIDENCE: f64 = 0.95;

/// Lower and upper end of an interval that holds the true value with some confidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    pub low: f64,
    pub high: f64,
}

/// Interval of the mean of values that are independent between sites, not within one: Student's t with G - 1 degrees of
/// freedom for G sites, and the variance of the mean from the sums of deviations of each site, G/(G - 1) sum(S_j^2)/n^2
/// (cluster-robust; Liang and Zeger 1986). With one value per site this is the usual interval.
///
/// `site` numbers the site of each value from 0. `None` for fewer than two sites, lists of different length, a value that is
/// not finite, or a confidence not between 0 and 1.
pub fn mean_interval(values: &[f64], site: &[usize], confidence: f64) -> Option<Interval> {
    let mean = mean(values)?;
    let sums = sums_of_sites(values, site, mean)?;
    let (sites, count) = (sums.len() as f64, values.len() as f64);
    let squares = sum_of(&sums, |sum| sum * sum);
    let error = (sites / (sites - 1.0) * squares).sqrt() / count;
    let reach = student_quantile(upper_tail(confidence)?, sites - 1.0)? * error;
    Some(Interval { low: mean - reach, high: mean + reach }).filter(Interval::is_finite)
}

/// Interval of the standard deviation, chi-square with G - 1 degrees of freedom for G sites, equal tails: values of one site
/// are taken for one, since how far they depend on each other is not known. With one value per site this is the usual
/// interval.
///
/// `site` and `None` as in [`mean_interval`].
pub fn standard_deviation_interval(values: &[f64], site: &[usize], confidence: f64) -> Option<Interval> {
    let deviation = standard_deviation(values, Divisor::Sample)?;
    let degrees = sums_of_sites(values, site, 0.0)?.len() as f64 - 1.0;
    let chi_squared = ChiSquared::new(degrees).ok()?;
    let upper = upper_tail(confidence)?;
    let end = |probability: f64| deviation * (degrees / chi_squared.inverse_cdf(probability)).sqrt();
    Some(Interval { low: end(upper), high: end(1.0 - upper) }).filter(Interval::is_finite)
}

/// Sum of value - `center` of each site that has values, in the order of their first value; two sites at least.
fn sums_of_sites(values: &[f64], site: &[usize], center: f64) -> Option<Vec<f64>> {
    if values.len() != site.len() {
        return None;
    }
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by_key(|&at| site[at]);
    let sites = order.chunk_by(|&a, &b| site[a] == site[b]);
    let sums: Vec<f64> = sites.map(|of_site| sum(&of_site.iter().map(|&at| values[at] - center).collect::<Vec<_>>())).collect();
    (sums.len() > 1).then_some(sums)
}

/// Interval of a share, 95 % (Wilson 1927): how many of how many. Of none every share is possible.
#[must_use]
pub fn wilson(good: u64, all: u64) -> (f64, f64) {
    /// 97.5 % value of the normal distribution.
    const NORMAL: f64 = 1.959_963_984_540_054;
    if all == 0 {
        return (0.0, 1.0);
    }
    let (n, p) = (all as f64, good as f64 / all as f64);
    let square = NORMAL * NORMAL;
    let center = (p + square / (2.0 * n)) / (1.0 + square / n);
    let half = NORMAL / (1.0 + square / n) * (p * (1.0 - p) / n + square / (4.0 * n * n)).sqrt();
    // At the ends the two terms cancel, but for rounding.
    (if good == 0 { 0.0 } else { (center - half).max(0.0) }, if good == all { 1.0 } else { (center + half).min(1.0) })
}

impl Interval {
    fn is_finite(&self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }
}

fn upper_tail(confidence: f64) -> Option<f64> {
    (confidence > 0.0 && confidence < 1.0).then_some(0.5 + confidence / 2.0)
}
