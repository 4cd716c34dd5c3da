//! Spectra by Welch's method: means over windows of a signal that overlap.

use std::{f64::consts::TAU, sync::Arc};

use realfft::{RealToComplex, num_complex::Complex};

use super::{
    fourier,
    pair::{Undefined, undefined},
};

/// What is taken away from each window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trend {
    Mean,
    /// The regression line: the lines of a slow change would cover the noise.
    Line,
}

/// Periodic Hann windows of one length, and their transform.
#[allow(missing_debug_implementations)]
pub struct Windows {
    hann: Vec<f64>,
    transform: Arc<dyn RealToComplex<f64>>,
    trend: Trend,
}

impl Windows {
    /// Windows of so many samples.
    pub fn new(length: usize, trend: Trend) -> Self {
        let hann = (0..length).map(|k| 0.5 - 0.5 * (TAU * k as f64 / length as f64).cos());
        Self { hann: hann.collect(), transform: fourier::forward(length), trend }
    }

    /// The first samples of windows that begin every `step` samples inside `count` samples.
    pub fn starts(&self, count: usize, step: usize) -> impl Iterator<Item = usize> + use<> {
        (0..=count - self.hann.len()).step_by(step)
    }

    /// The lines of the window that begins at a sample, from 0 to half the sampling rate; not
    /// normalised.
    ///
    /// # Errors
    /// The transform fails.
    pub fn lines(&self, values: &[f64], start: usize) -> Result<Vec<Complex<f64>>, Undefined> {
        let length = self.hann.len();
        let part = &values[start..start + length];
        // From the first value on: of equal values exactly nothing is left.
        let first = part[0];
        let mean = first + part.iter().map(|value| value - first).sum::<f64>() / length as f64;
        let middle = (length - 1) as f64 / 2.0;
        let slope = match self.trend {
            Trend::Mean => 0.0,
            Trend::Line => {
                let spread = (length * (length * length - 1)) as f64 / 12.0;
                let of = |(k, value): (usize, &f64)| (k as f64 - middle) * value;
                part.iter().enumerate().map(of).sum::<f64>() / spread
            }
        };
        let line = |k: usize| mean + slope * (k as f64 - middle);
        let values = part.iter().zip(&self.hann).enumerate();
        let mut windowed: Vec<f64> =
            values.map(|(k, (value, weight))| (value - line(k)) * weight).collect();
        let mut found = self.transform.make_output_vec();
        self.transform
            .process(&mut windowed, &mut found)
            .map_err(|error| Undefined::because(error.to_string()))?;
        Ok(found)
    }
}

/// Least number of samples of a segment: a Hann window is four lines wide, and of fewer samples
/// than twice that no line is apart from the others.
const SHORTEST: usize = 8;
/// How far outside the band a line may lie that is at its edge, as a share of the distance of the
/// lines: the sampling rate of a record is known from rounded times.
const EDGE: f64 = 0.01;
/// How far the number of samples that overlap may be below a whole number by rounding: 57 % of 100.
const ROUNDING: f64 = 1e-9;

/// How a power spectral density is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Density {
    /// Length of a segment, s.
    pub segment: f64,
    /// The share of a segment that the next one repeats, from 0 to below 1.
    pub overlap: f64,
    /// The first and the last frequency that is asked for, Hz.
    pub band: Option<(f64, f64)>,
}

impl Density {
    /// The frequencies of the lines above 0 Hz, and the one-sided power spectral density there: the
    /// mean over the segments inside the samples, Hann windows without their mean. `rate` is in
    /// samples per second; the density has the unit of the values squared, per Hz.
    ///
    /// # Errors
    /// Fewer samples than a segment; too short a segment; no line in the band.
    pub fn of(&self, values: &[f64], rate: f64) -> Result<(Vec<f64>, Vec<f64>), Undefined> {
        let length = (self.segment * rate).round() as usize;
        let (count, segment) = (values.len(), super::rounded(self.segment));
        if length < SHORTEST {
            return undefined(format!(
                "a segment of {segment} s has {length} samples, and a spectrum needs {SHORTEST}"
            ));
        }
        if count < length {
            return undefined(format!(
                "{count} samples are fewer than the {length} of a segment of {segment} s"
            ));
        }
        let apart = rate / length as f64;
        let inside = |line: &usize| match self.band {
            None => true,
            Some((low, high)) => {
                (low - EDGE * apart..=high + EDGE * apart).contains(&(*line as f64 * apart))
            }
        };
        let lines: Vec<usize> = (1..=length / 2).filter(inside).collect();
        if lines.is_empty() {
            let apart = super::rounded(apart);
            return undefined(format!(
                "no line of the spectrum lies in the band: the lines are {apart} Hz apart, up to half the sampling rate"
            ));
        }
        let windows = Windows::new(length, Trend::Mean);
        let overlap = (self.overlap * length as f64 + ROUNDING).floor() as usize;
        let mut sums = vec![0.0; lines.len()];
        let mut segments = 0_usize;
        for start in windows.starts(count, (length - overlap).max(1)) {
            let found = windows.lines(values, start)?;
            lines.iter().zip(&mut sums).for_each(|(line, sum)| *sum += found[*line].norm_sqr());
            segments += 1;
        }
        let power: f64 = windows.hann.iter().map(|weight| weight * weight).sum();
        let scale = 1.0 / (rate * power * segments as f64);
        // The line at half the sampling rate has no mirror image.
        let sides = |line: usize| if 2 * line == length { 1.0 } else { 2.0 };
        let density = lines.iter().zip(sums).map(|(line, sum)| sides(*line) * scale * sum);
        let density: Vec<f64> = density.collect();
        if density.iter().any(|value| !value.is_finite()) {
            return undefined("the spectrum is not finite");
        }
        Ok((lines.iter().map(|line| *line as f64 * apart).collect(), density))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whole and quarter numbers, the same everywhere.
    fn signal(count: u64) -> Vec<f64> {
        let at = |k: u64| ((7 * k * k + 3 * k) % 101) as f64 - 40.0 + ((13 * k) % 17) as f64 / 4.0;
        (0..count).map(at).collect()
    }

    const HALF: Density = Density { segment: 0.5, overlap: 0.5, band: None };

    /// Its number, its frequency and the density there.
    type Line = (usize, f64, f64);

    /// `scipy.signal.welch` of the same 403 values, `nperseg` and `noverlap` of samples; 1e-9.
    #[test]
    fn densities_agree_with_scipy() {
        let cases: [(f64, Density, &[Line]); 4] = [
            (
                200.0,
                HALF,
                &[
                    (1, 2.0, 9.560771755045902),
                    (25, 50.0, 1.3541421514361596),
                    (50, 100.0, 1.3161663454523111),
                ],
            ),
            (
                200.0,
                Density { overlap: 0.75, ..HALF },
                &[(2, 4.0, 3.8877778484117544), (50, 100.0, 2.001402249829127)],
            ),
            // 101 samples: half of them are 50, and the last line is below half the rate.
            (
                200.0,
                Density { segment: 0.505, ..HALF },
                &[
                    (1, 1.9801980198019802, 9.535879914260144),
                    (50, 99.00990099009901, 3.517571804546678),
                ],
            ),
            (
                50.0,
                Density { segment: 0.66, overlap: 18.0 / 33.0, band: None },
                &[
                    (2, 3.0303030303030303, 57.93770429600899),
                    (16, 24.242424242424242, 49.74374452914907),
                ],
            ),
        ];
        for (rate, density, expected) in cases {
            let (frequencies, found) = density.of(&signal(403), rate).expect("a spectrum");
            assert_eq!(frequencies.len(), expected[expected.len() - 1].0);
            for &(line, frequency, value) in expected {
                assert!((frequencies[line - 1] - frequency).abs() < 1e-12 * frequency);
                assert!((found[line - 1] - value).abs() < 1e-9 * value, "{line}: {found:?}");
            }
        }
    }

    /// Closed form: the line of a tone of amplitude A that has whole periods in a segment of T
    /// seconds is A² T/3, its neighbours are a quarter of it, and the sum over all lines, times
    /// their distance, is the mean square A²/2.
    #[test]
    fn the_lines_of_a_tone() {
        let tone: Vec<f64> =
            (0..2000).map(|k| 3.0 * (TAU * 5.0 * k as f64 / 200.0).sin()).collect();
        let density = Density { segment: 2.0, overlap: 0.5, band: None };
        let (frequencies, found) = density.of(&tone, 200.0).expect("a spectrum");
        for (line, wanted) in [(8, 1.5), (9, 6.0), (10, 1.5)] {
            assert!(
                (found[line] - wanted).abs() < 1e-9,
                "{} Hz: {}",
                frequencies[line],
                found[line]
            );
        }
        assert!((found.iter().sum::<f64>() / 2.0 - 4.5).abs() < 1e-9);
        let band = Density { band: Some((4.5, 5.5)), ..density };
        // The rate of rounded times: the lines at the edges are still those of the band.
        let (lines, _) = band.of(&tone, 199.999).expect("a spectrum");
        assert_eq!(lines.len(), 3);
    }

    #[test]
    fn what_has_no_spectrum_says_why() {
        let why = |density: Density, count: u64, rate: f64| {
            density.of(&signal(count), rate).expect_err("no spectrum").reason
        };
        assert!(why(HALF, 99, 200.0).contains("99 samples are fewer than the 100"));
        assert!(why(HALF, 99, 10.0).contains("has 5 samples"));
        assert!(why(Density { band: Some((2.1, 3.9)), ..HALF }, 400, 200.0).contains("2 Hz apart"));
        assert!(
            why(Density { band: Some((101.0, 120.0)), ..HALF }, 400, 200.0).contains("no line")
        );
        assert!(HALF.of(&[f64::NAN; 100], 200.0).is_err());
        // Of a signal that does not change exactly nothing is left.
        let (_, nothing) = HALF.of(&[0.1; 300], 200.0).expect("a spectrum");
        assert!(nothing.iter().all(|value| *value == 0.0));
    }
}
