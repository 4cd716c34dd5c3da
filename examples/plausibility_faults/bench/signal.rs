//! Operations on the samples of a channel.

use fishplate::effects::Gauss;
use fishplate::metrics::filter::{Band, Cutoff, Filter, Phase};

use super::folder::Record;

pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

pub fn deviation(values: &[f64]) -> f64 {
    let mean = mean(values);
    mean_of(values, |value| (value - mean).powi(2)).sqrt()
}

fn mean_of(values: &[f64], of: impl Fn(f64) -> f64) -> f64 {
    values.iter().map(|value| of(*value)).sum::<f64>() / values.len().max(1) as f64
}

/// The value below which a share of the samples lies.
pub fn percentile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[((sorted.len() - 1) as f64 * share).round() as usize]
}

/// Samples per second.
pub fn rate(record: &Record) -> f64 {
    let time = record.values("time");
    (time.len() - 1) as f64 / (time[time.len() - 1] - time[0])
}

/// Without delay.
pub fn filtered(values: &[f64], band: Band, rate: f64) -> Vec<f64> {
    let filter = Filter::design(band, 2, rate, Phase::Zero, Cutoff::AsApplied);
    filter.ok().and_then(|filter| filter.apply(values).ok()).unwrap_or_else(|| values.to_vec())
}

pub fn with_noise(values: &[f64], sigma: f64, seed: u64) -> Vec<f64> {
    let mut random = Gauss::new(seed);
    values.iter().map(|value| value + sigma * random.next()).collect()
}

/// Each sample as a function of its number and value.
pub fn each(values: &[f64], of: impl Fn(usize, f64) -> f64) -> Vec<f64> {
    values.iter().enumerate().map(|(n, value)| of(n, *value)).collect()
}

/// Later by a number of samples.
pub fn delayed(values: &[f64], by: f64) -> Vec<f64> {
    each(values, |n, _| super::made::cubic(values, (n as f64 - by).max(0.0)))
}

/// The values of another record, brought to as many samples by their distance.
pub fn at_distances(from: &Record, channel: &str, distances: &[f64]) -> Vec<f64> {
    let mut at = 0;
    let (axis, values) = (from.values("distance"), from.values(channel));
    let of = |x: &f64| fishplate::simulate::interpolated(axis, values, *x, &mut at);
    distances.iter().map(of).collect()
}
