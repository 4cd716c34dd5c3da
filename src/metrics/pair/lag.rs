//! The shift by which two signals agree best, as ISO/TS 18571 and CORA look for it.

use realfft::num_complex::Complex;

use super::{Undefined, undefined};
use crate::metrics::{
    fourier,
    sum::{RunningSums, sum_of},
};

/// A larger shift has to agree better by more than this. Differences below are rounding, and of
/// equal ones the smaller shift counts.
const TIE: f64 = 1e-12;
/// A part of a signal with less than this share of its energy is constant but for rounding.
const CONSTANT: f64 = 1e-12;

/// What is compared at each shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Agreement {
    /// Pearson's correlation.
    Correlation,
    /// The cosine of the angle between the signals: the means are not removed.
    Cosine,
}

/// The shift in samples, at most so many: above zero where the simulated signal is late, and is
/// moved to the left.
///
/// Only where the signals overlap are they compared. Of equal agreement the smaller shift counts,
/// then the one to the left.
pub fn best_shift(
    simulated: &[f64],
    measured: &[f64],
    most: usize,
    by: Agreement,
) -> Result<isize, Undefined> {
    let all = agreements(simulated, measured, most, by)?;
    let most = all.len() / 2;
    let mut best = all[most];
    if best == f64::NEG_INFINITY {
        return undefined("one of the signals is constant");
    }
    let mut found = 0;
    for by_samples in 1..=most as isize {
        for shift in [by_samples, -by_samples] {
            let here = all[(shift + most as isize) as usize];
            if here > best + TIE {
                (best, found) = (here, shift);
            }
        }
    }
    Ok(found)
}

/// The agreement at each shift from -most to most; below all others where a part is constant.
pub fn agreements(
    simulated: &[f64],
    measured: &[f64],
    most: usize,
    by: Agreement,
) -> Result<Vec<f64>, Undefined> {
    let count = simulated.len();
    let most = most.min(count.saturating_sub(1));
    // Near zero mean, so that nothing cancels in the sums below.
    let centred = |signal: &[f64]| -> Vec<f64> {
        let mean = if by == Agreement::Correlation {
            sum_of(signal, |value| value) / count as f64
        } else {
            0.0
        };
        signal.iter().map(|value| value - mean).collect()
    };
    let (s, m) = (centred(simulated), centred(measured));
    let products = products(&s, &m, most)?;
    let (sums_s, sums_m) =
        (RunningSums::new(s.iter().copied()), RunningSums::new(m.iter().copied()));
    let (squares_s, squares_m) =
        (RunningSums::new(s.iter().map(|v| v * v)), RunningSums::new(m.iter().map(|v| v * v)));
    let least = (CONSTANT * squares_s.between(0, count), CONSTANT * squares_m.between(0, count));
    let agreement = |shift: isize| -> f64 {
        let by_samples = shift.unsigned_abs();
        let length = count - by_samples;
        let (from_s, from_m) = if shift > 0 { (by_samples, 0) } else { (0, by_samples) };
        let mut product = products[(shift + most as isize) as usize];
        let mut energy_s = squares_s.between(from_s, from_s + length);
        let mut energy_m = squares_m.between(from_m, from_m + length);
        if by == Agreement::Correlation {
            let (sum_s, sum_m) =
                (sums_s.between(from_s, from_s + length), sums_m.between(from_m, from_m + length));
            product -= sum_s * sum_m / length as f64;
            energy_s -= sum_s * sum_s / length as f64;
            energy_m -= sum_m * sum_m / length as f64;
        }
        if energy_s > least.0 && energy_m > least.1 {
            product / (energy_s * energy_m).sqrt()
        } else {
            f64::NEG_INFINITY
        }
    };
    Ok((-(most as isize)..=most as isize).map(agreement).collect())
}

/// The parts of both signals that overlap after the simulated one is moved to the left by so many
/// samples.
pub fn overlap<'a>(
    simulated: &'a [f64],
    measured: &'a [f64],
    shift: isize,
) -> (&'a [f64], &'a [f64]) {
    let by_samples = shift.unsigned_abs();
    let length = simulated.len() - by_samples;
    if shift > 0 {
        (&simulated[by_samples..], &measured[..length])
    } else {
        (&simulated[..length], &measured[by_samples..])
    }
}

/// Sums of the products of both signals, for the simulated one moved to the left by -most ..= most
/// samples.
fn products(simulated: &[f64], measured: &[f64], most: usize) -> Result<Vec<f64>, Undefined> {
    // Zeros behind the signals, so that what is moved out at one end does not come in at the other.
    let length = (simulated.len() + most).next_power_of_two().max(2);
    let forward = fourier::forward(length);
    let failed = |error: realfft::FftError| Undefined::because(error.to_string());
    let spectrum = |signal: &[f64]| -> Result<Vec<Complex<f64>>, Undefined> {
        let mut padded = signal.to_vec();
        padded.resize(length, 0.0);
        let mut found = forward.make_output_vec();
        forward.process(&mut padded, &mut found).map_err(failed)?;
        Ok(found)
    };
    let of_measured = spectrum(measured)?;
    let mut of_both: Vec<Complex<f64>> =
        spectrum(simulated)?.iter().zip(&of_measured).map(|(s, m)| s * m.conj()).collect();
    let backward = fourier::inverse(length);
    let mut found = backward.make_output_vec();
    backward.process(&mut of_both, &mut found).map_err(failed)?;
    let at = |lag: isize| found[lag.rem_euclid(length as isize) as usize] / length as f64;
    Ok((-(most as isize)..=most as isize).map(at).collect())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    fn wave(count: usize, late: f64) -> Vec<f64> {
        (0..count)
            .map(|k| k as f64 - late)
            .map(|x| (TAU * x / 90.0).sin() + 0.4 * (TAU * x / 37.0).cos() + 0.7)
            .collect()
    }

    #[test]
    fn a_known_shift_is_found_either_way() {
        let measured = wave(600, 0.0);
        for by in [Agreement::Correlation, Agreement::Cosine] {
            assert_eq!(best_shift(&wave(600, 13.0), &measured, 120, by), Ok(13));
            assert_eq!(best_shift(&wave(600, -21.0), &measured, 120, by), Ok(-21));
            assert_eq!(best_shift(&measured, &measured, 120, by), Ok(0));
        }
    }

    /// After a period a sine agrees with itself as well as at no shift.
    #[test]
    fn of_equal_shifts_the_smallest_counts() {
        let sine: Vec<f64> = (0..500).map(|k| (TAU * f64::from(k) / 50.0).sin()).collect();
        assert_eq!(best_shift(&sine, &sine, 100, Agreement::Correlation), Ok(0));
        // Half a period: either way is equally far, and left is first.
        let inverted: Vec<f64> = sine.iter().map(|value| -value).collect();
        assert_eq!(best_shift(&inverted, &sine, 100, Agreement::Correlation), Ok(25));
    }

    #[test]
    fn products_are_those_of_the_samples() {
        let (s, m) = (wave(41, 3.0), wave(41, 0.0));
        let found = products(&s, &m, 8).expect("a transform");
        for (at, lag) in (-8..=8).enumerate() {
            let (s, m) = overlap(&s, &m, lag);
            let expected: f64 = s.iter().zip(m).map(|(s, m)| s * m).sum();
            assert!((found[at] - expected).abs() < 1e-12, "{lag}: {} is not {expected}", found[at]);
        }
    }

    #[test]
    fn a_constant_signal_has_no_shift() {
        let measured = wave(100, 0.0);
        assert!(best_shift(&[1.0; 100], &measured, 20, Agreement::Correlation).is_err());
        assert!(best_shift(&[0.0; 100], &measured, 20, Agreement::Cosine).is_err());
    }
}
