//! Coherence of two signals: the share of one that depends linearly on the other, as a function of
//! frequency (Welch).

use std::f64::consts::TAU;

use realfft::num_complex::Complex;

use super::pair::{Metric, Undefined, undefined};

/// Number of samples of a window. The spectral lines are 1/256 of the sampling rate apart: 0.8 Hz
/// at 200 samples per second.
pub const WINDOW: usize = 256;
/// Samples from one window to the next: 50 % overlap.
const ADVANCE: usize = WINDOW / 2;

/// Mean coherence of the spectral lines with low <= f < high, for a sampling rate and frequencies
/// in the same unit.
///
/// The spectra are averages over periodic Hann windows, each with its mean removed. With a single
/// window, the coherence is 1 at every frequency, for any signals.
///
/// # Errors
/// Fewer samples than a window; no spectral line in the band; a signal without content at a line of
/// the band.
pub fn in_band(simulated: &[f64], measured: &[f64], rate: f64, (low, high): (f64, f64)) -> Metric {
    if simulated.len() != measured.len() || simulated.len() < WINDOW {
        let count = simulated.len().min(measured.len());
        return undefined(format!(
            "the signals have {count} samples; a window of the coherence needs {WINDOW}"
        ));
    }
    let lines: Vec<usize> = (0..=WINDOW / 2)
        .filter(|&line| (low..high).contains(&(line as f64 * rate / WINDOW as f64)))
        .collect();
    if lines.is_empty() {
        let apart = super::rounded(rate / WINDOW as f64);
        return undefined(format!(
            "no line of the spectrum lies in the band: the lines are {apart} apart"
        ));
    }
    let hann: Vec<f64> =
        (0..WINDOW).map(|k| 0.5 - 0.5 * (TAU * k as f64 / WINDOW as f64).cos()).collect();
    let transform = super::fourier::forward(WINDOW);
    let spectrum = |part: &[f64]| -> Result<Vec<Complex<f64>>, Undefined> {
        let mean = part.iter().sum::<f64>() / WINDOW as f64;
        let mut windowed: Vec<f64> =
            part.iter().zip(&hann).map(|(value, weight)| (value - mean) * weight).collect();
        let mut found = transform.make_output_vec();
        transform
            .process(&mut windowed, &mut found)
            .map_err(|error| Undefined::because(error.to_string()))?;
        Ok(found)
    };
    let mut of_s = vec![0.0; lines.len()];
    let mut of_m = vec![0.0; lines.len()];
    let mut of_both = vec![Complex::new(0.0, 0.0); lines.len()];
    for start in (0..=simulated.len() - WINDOW).step_by(ADVANCE) {
        let (s, m) = (
            spectrum(&simulated[start..start + WINDOW])?,
            spectrum(&measured[start..start + WINDOW])?,
        );
        for (at, &line) in lines.iter().enumerate() {
            of_s[at] += s[line].norm_sqr();
            of_m[at] += m[line].norm_sqr();
            of_both[at] += s[line].conj() * m[line];
        }
    }
    let mut sum = 0.0;
    for ((s, m), both) in of_s.iter().zip(&of_m).zip(&of_both) {
        let one = both.norm_sqr() / (s * m);
        if !one.is_finite() {
            return undefined("one of the signals has no content at a frequency of the band");
        }
        sum += one;
    }
    Ok(sum / lines.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(count: usize, mut state: u64) -> Vec<f64> {
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
        };
        (0..count).map(|_| next()).collect()
    }

    #[test]
    fn a_multiple_is_wholly_coherent_and_noise_is_not() {
        let a = noise(20_000, 1);
        let b: Vec<f64> = a.iter().map(|value| -3.0 * value + 2.0).collect();
        assert!((in_band(&a, &b, 200.0, (1.0, 20.0)).expect("a number") - 1.0).abs() < 1e-12);
        // For n windows of independent noise, the mean is about 1/n; with 50 % overlap it is
        // somewhat larger.
        let none = in_band(&a, &noise(20_000, 2), 200.0, (1.0, 20.0)).expect("a number");
        assert!(none < 0.03, "{none}");
    }

    #[test]
    fn what_has_no_coherence_says_why() {
        let a = noise(255, 1);
        assert!(
            in_band(&a, &a, 200.0, (1.0, 20.0)).expect_err("short").reason.contains("255 samples")
        );
        let a = noise(300, 1);
        assert!(
            in_band(&a, &a, 200.0, (1.0, 1.1))
                .expect_err("no line")
                .reason
                .contains("0.78125 apart")
        );
        assert!(in_band(&a, &vec![1.0; 300], 200.0, (1.0, 20.0)).is_err());
    }
}
