//! Statistics of values with weights. Only the ratios of the weights matter; a value of weight 0
//! does not count.
//!
//! `None` where the number is not defined: no weight above zero, fewer such values than the divisor
//! needs, numbers that are not finite.

use super::{
    statistics::finite,
    sum::{sum_of, sum_of_pairs},
};

/// How many values of equal weight say as much of the mean: squared sum of the weights over the sum
/// of their squares (Kish, "Survey Sampling", 1965).
pub fn effective_count(weights: &[f64]) -> Option<f64> {
    finite(total(weights)?.powi(2) / sum_of(weights, |weight| weight * weight))
}

pub fn mean(values: &[f64], weights: &[f64]) -> Option<f64> {
    finite(sum_of_pairs(values, weights, |value, weight| value * weight) / total(weights)?)
}

/// Root of the weighted mean of the squares.
pub fn rms(values: &[f64], weights: &[f64]) -> Option<f64> {
    finite(
        (sum_of_pairs(values, weights, |value, weight| value * value * weight) / total(weights)?)
            .sqrt(),
    )
}

/// Root of the weighted mean of the squared deviations, times n/(n - ddof) with the effective n:
/// with weights that are alike the usual standard deviation.
pub fn standard_deviation(values: &[f64], weights: &[f64], ddof: usize) -> Option<f64> {
    let counting = counting(values, weights);
    if counting.len() <= ddof {
        return None;
    }
    let mean = mean(values, weights)?;
    if counting.iter().all(|(value, _)| *value == counting[0].0) {
        return Some(0.0);
    }
    let squares =
        sum_of_pairs(values, weights, |value, weight| weight * (value - mean) * (value - mean))
            / total(weights)?;
    let count = effective_count(weights)?;
    finite((squares * count / (count - ddof as f64)).sqrt())
}

/// A percentile: the mean of the sorted values over the part of the cumulative weight from q (1 -
/// 1/n) to q (1 - 1/n) + 1/n, n being the effective count and q the percentage as a share
/// (Akinshin, "Weighted quantile estimators", Communications in Statistics 2024, type 7). With
/// weights that are alike it is linear between two values.
pub fn percentile(values: &[f64], weights: &[f64], percent: f64) -> Option<f64> {
    let mut sorted = counting(values, weights);
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (total, share) = (total(weights)?, 1.0 / effective_count(weights)?);
    let from = percent / 100.0 * (1.0 - share);
    let to = from + share;
    let (mut below, mut sum, mut width) = (0.0, 0.0, 0.0);
    for (value, weight) in sorted {
        let above = below + weight / total;
        let inside = (above.min(to) - below.max(from)).max(0.0);
        sum += value * inside;
        width += inside;
        below = above;
    }
    finite(sum / width)
}

/// Values that count, with their weights.
fn counting(values: &[f64], weights: &[f64]) -> Vec<(f64, f64)> {
    values
        .iter()
        .copied()
        .zip(weights.iter().copied())
        .filter(|(_, weight)| *weight > 0.0)
        .collect()
}

fn total(weights: &[f64]) -> Option<f64> {
    Some(sum_of(weights, |weight| weight)).filter(|total| *total > 0.0 && total.is_finite())
}
