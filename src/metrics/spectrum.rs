//! Single lines in the spectrum of a signal: interference of a fixed frequency.

use super::{
    fourier,
    statistics::{mean, median},
};

/// The first line that is looked at, in periods over the signal: below, the track, the curve and
/// the modes of the body have few periods in a section and look like lines.
const FIRST: f64 = 24.0;
/// The lines around a peak that it is compared with, in periods over the signal: from here, where
/// the peak itself has ended behind the window of Hann ...
const BESIDE: f64 = 4.0;
/// ... to here.
const REACH: f64 = 20.0;

/// The strongest single line: its power over the median of the lines around, on the side where
/// these are stronger, and its frequency in periods per sample. About 10 for noise, and more for a
/// resonance.
///
/// `None` for a signal too short to have lines around a peak, or with a sample that is not finite.
pub fn strongest_line(values: &[f64]) -> Option<(f64, f64)> {
    let middle = mean(values).filter(|middle| middle.is_finite())?;
    let (count, padded) = (values.len() as f64, values.len().next_power_of_two());
    let lines_per_period = padded as f64 / count;
    let bins = |periods: f64| (periods * lines_per_period).round() as usize;
    let (first, beside, reach) = (bins(FIRST), bins(BESIDE), bins(REACH));
    let power = power(values, middle, padded)?;
    if first + reach >= power.len() {
        return None;
    }
    let mut strongest = (0.0, 0.0);
    for at in first..power.len() - 1 {
        let around = &power[at.saturating_sub(reach)..power.len().min(at + reach + 1)];
        let peak = power[at];
        if power[at - 1] > peak || power[at + 1] > peak || around.iter().any(|line| *line > peak) {
            continue;
        }
        let before = median(&power[at.saturating_sub(reach).max(1)..=at - beside])?;
        let behind = power.get(at + beside..power.len().min(at + reach + 1));
        let behind = behind.and_then(median).unwrap_or(0.0);
        let ratio = peak / before.max(behind);
        if ratio.is_finite() && ratio > strongest.0 {
            strongest = (ratio, at as f64 / padded as f64);
        }
    }
    Some(strongest)
}

/// Behind a window of Hann, with zeros behind the samples.
fn power(values: &[f64], middle: f64, padded: usize) -> Option<Vec<f64>> {
    let transform = fourier::forward(padded);
    let mut samples = transform.make_input_vec();
    let step = std::f64::consts::TAU / (values.len() - 1).max(1) as f64;
    for (at, (sample, value)) in samples.iter_mut().zip(values).enumerate() {
        *sample = (value - middle) * (1.0 - (at as f64 * step).cos());
    }
    let mut lines = transform.make_output_vec();
    transform.process(&mut samples, &mut lines).ok()?;
    Some(lines.into_iter().map(|line| line.norm_sqr()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::random::mixed;

    /// White noise of variance 1/12.
    fn noise(count: usize) -> Vec<f64> {
        (0..count as u64).map(|at| (mixed(at) >> 11) as f64 / (1_u64 << 53) as f64).collect()
    }

    /// The power of a wave of amplitude A is n A^2 / 4 times that of white noise of variance 1, of
    /// which the window of Hann leaves two thirds, over the median 0.69 of the lines.
    #[test]
    fn a_wave_in_noise() {
        let wave = |at: usize, amplitude: f64| amplitude * (at as f64 * 0.37).sin();
        for count in [700, 1024, 1400] {
            let with = |amplitude| {
                let hum = |(at, value): (usize, f64)| value + wave(at, amplitude);
                let values: Vec<f64> = noise(count).into_iter().enumerate().map(hum).collect();
                strongest_line(&values).expect("finite")
            };
            let (ratio, frequency) = with(0.5);
            let expected = count as f64 * 0.25 / 4.0 * 12.0 * (2.0 / 3.0) / 0.69;
            assert!((0.5..2.0).contains(&(ratio / expected)), "{count}: {ratio} {expected}");
            assert!((frequency * std::f64::consts::TAU - 0.37).abs() < 4.0 / count as f64);
            assert!(with(0.0).0 < 25.0, "{:?}", with(0.0));
        }
    }

    /// A spectrum that falls has no line, nor has a signal without power.
    #[test]
    fn what_has_no_line() {
        let mut sum = 0.0;
        let slope: Vec<f64> = noise(1000)
            .into_iter()
            .map(|value| {
                sum = 0.98 * sum + value - 0.5;
                sum
            })
            .collect();
        assert!(strongest_line(&slope).is_some_and(|(ratio, _)| ratio < 40.0));
        assert_eq!(strongest_line(&[2.0; 500]), Some((0.0, 0.0)));
        assert_eq!((strongest_line(&[1.0; 20]), strongest_line(&[f64::NAN; 500])), (None, None));
    }
}
