//! Disturbances of sampled signals: offset, gain, delay and noise of a stated rms.

use std::ops::Range;

use super::random::{GOLDEN, mixed};

/// Standard deviation of samples with the divisor n; `None` where it is zero or there are no
/// samples.
pub fn deviation(values: &[f64]) -> Option<f64> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / n;
    // The rounding of the mean is no scatter.
    let deviation = variance.sqrt();
    (deviation.is_finite() && deviation > ROUNDING * mean.abs()).then_some(deviation)
}

/// A standard deviation up to this share of the mean is rounding: the signal is constant.
const ROUNDING: f64 = 1e-12;

pub fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// Noise of rms 1 over the samples of a range: white, independent of all other streams, the same
/// for the same stream.
///
/// Each sample is a function of its number and the stream alone (SplitMix64), a sum of twelve
/// uniform numbers less six.
pub fn noise(stream: u64, samples: usize, rows: Range<usize>) -> Vec<f64> {
    let start = mixed(stream);
    let mut values: Vec<f64> =
        (0..samples as u64).map(|sample| nearly_normal(start, sample)).collect();
    let rms = root_mean_square(&values[rows]);
    if rms > 0.0 {
        values.iter_mut().for_each(|value| *value /= rms);
    }
    values
}

/// Numbers of 16 bits in a sum, four from each word.
const TERMS: u64 = 12;

fn nearly_normal(start: u64, sample: u64) -> f64 {
    let words = (0..TERMS / 4)
        .map(|word| mixed(start.wrapping_add((sample * TERMS / 4 + word).wrapping_mul(GOLDEN))));
    let sum: u64 =
        words.map(|word| (0..4).map(|part| (word >> (16 * part)) & 0xFFFF).sum::<u64>()).sum();
    // Each is a whole number below 2^16; its mean is half of the largest.
    (sum as f64 - TERMS as f64 * 32_767.5) / 65_536.0
}

/// The number of a stream of random numbers, from the names it belongs to (FNV-1a).
pub fn stream<'a>(names: impl IntoIterator<Item = &'a str>) -> u64 {
    let bytes = names.into_iter().flat_map(|name| name.bytes().chain([0]));
    bytes.fold(0xCBF2_9CE4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3)
    })
}

/// A signal later by a number of samples, which need not be whole: between samples it is a straight
/// line, before the first it stays.
pub fn delayed(values: &[f64], samples: f64) -> Vec<f64> {
    let whole = samples.floor();
    let part = samples - whole;
    let at = |row: usize, back: usize| values[row.saturating_sub(back)];
    let back = whole as usize;
    (0..values.len()).map(|row| at(row, back) * (1.0 - part) + at(row, back + 1) * part).collect()
}

/// The smallest delay, in samples, that changes signals by a size: the root mean square over
/// samples and signals of the change divided by the standard deviation of each signal. Each signal
/// is given with this deviation.
///
/// `None` where no delay up to half of the range does.
pub fn delay_of_size(signals: &[(&[f64], f64)], rows: Range<usize>, size: f64) -> Option<f64> {
    let most = rows.len() / 2;
    if signals.is_empty() || size <= 0.0 {
        return None;
    }
    let wanted = size * size;
    let square = |delay: usize| {
        mean(signals, rows.clone(), |values, row| values[row] - values[row.saturating_sub(delay)])
    };
    let mut before = 0.0;
    for delay in 1..=most {
        let after = square(delay);
        if after >= wanted {
            // Between two whole delays the change is a straight line from one to the other, and its
            // square a parabola.
            let step = |values: &[f64], row: usize| {
                values[row.saturating_sub(delay - 1)] - values[row.saturating_sub(delay)]
            };
            let curve = mean(signals, rows, step);
            let slope = after - before - curve;
            return Some((delay - 1) as f64 + root(curve, slope, before - wanted));
        }
        before = after;
    }
    None
}

/// Mean over rows and signals of a squared number, divided by the variance of its signal.
fn mean(signals: &[(&[f64], f64)], rows: Range<usize>, of: impl Fn(&[f64], usize) -> f64) -> f64 {
    let one = |(values, deviation): &(&[f64], f64)| {
        let sum: f64 = rows.clone().map(|row| of(values, row)).map(|change| change * change).sum();
        sum / (rows.len() as f64 * deviation * deviation)
    };
    signals.iter().map(one).sum::<f64>() / signals.len() as f64
}

/// The root in 0..1 of a x² + b x + c, which is not above zero at 0 and not below it at 1.
fn root(a: f64, b: f64, c: f64) -> f64 {
    let discriminant = (b * b - 4.0 * a * c).max(0.0).sqrt();
    // The form without cancellation.
    let root =
        if b >= 0.0 { -2.0 * c / (b + discriminant) } else { (discriminant - b) / (2.0 * a) };
    if root.is_finite() { root.clamp(0.0, 1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_its_rms_in_the_range_and_depends_on_its_stream() {
        let stream_of = |channel| stream(["S01", channel]);
        let rows = 100..4100;
        let a = noise(stream_of("Y_1R"), 5000, rows.clone());
        assert!((root_mean_square(&a[rows.clone()]) - 1.0).abs() < 1e-14);
        assert_eq!(a, noise(stream_of("Y_1R"), 5000, rows.clone()));
        let b = noise(stream_of("Y_1L"), 5000, rows.clone());
        let correlation = rows.clone().map(|row| a[row] * b[row]).sum::<f64>() / rows.len() as f64;
        // One standard deviation of a correlation of 4000 independent pairs is 0.016.
        assert!(correlation.abs() < 0.05, "{correlation}");
        let next = rows.clone().map(|row| a[row] * a[row + 1]).sum::<f64>() / rows.len() as f64;
        assert!(next.abs() < 0.05, "{next}");
        assert_ne!(stream(["ab", "c"]), stream(["a", "bc"]));
    }

    #[test]
    fn a_delay_has_the_size_that_was_asked_for() {
        let sine = |frequency: f64| {
            (0..4000).map(|row| (frequency * f64::from(row)).sin()).collect::<Vec<f64>>()
        };
        let (a, b) = (sine(0.01), sine(0.037));
        let rows = 500..3500;
        let signals: Vec<(&[f64], f64)> = [&a, &b]
            .map(|values| (values.as_slice(), deviation(&values[rows.clone()]).expect("scatter")))
            .to_vec();
        for size in [0.001, 0.02, 0.3, 1.0] {
            let delay = delay_of_size(&signals, rows.clone(), size).expect("a delay");
            let square: f64 = signals
                .iter()
                .map(|(values, deviation)| {
                    let moved = delayed(values, delay);
                    let change: Vec<f64> =
                        rows.clone().map(|row| moved[row] - values[row]).collect();
                    (root_mean_square(&change) / deviation).powi(2)
                })
                .sum();
            assert!(((square / 2.0).sqrt() - size).abs() < 1e-12, "{size}: delay {delay}");
        }
        assert_eq!(delay_of_size(&signals, rows, 2.5), None);
    }

    #[test]
    fn a_constant_signal_has_no_scatter() {
        assert_eq!(deviation(&[0.1; 77]), None);
        assert_eq!(deviation(&[1.0, 3.0]), Some(1.0));
    }
}
