//! Coherence of two signals: the share of one that depends linearly on the other, as a function of
//! frequency (Welch).

use std::{cell::OnceCell, ops::Range};

use realfft::num_complex::Complex;

use super::{
    pair::{
        Metric, Undefined,
        lag::{Agreement, best_shift, overlap},
        undefined,
    },
    welch::{Trend, Windows},
};

/// Number of samples of a window. The spectral lines are 1/256 of the sampling rate apart: 0.8 Hz
/// at 200 samples per second.
pub const WINDOW: usize = 256;
/// Number of spectral lines, or more, in the band in which shared content is looked for: fewer, and
/// windows are so short that lines beside the band reach into it.
const LINES: f64 = 3.0;
/// Least number of samples of such a window: a Hann window is four lines wide.
const SHORTEST: usize = 32;
/// Least number of windows: of fewer, unrelated signals share more than a tenth by chance.
const FEWEST: usize = 8;
/// Least number of windows of a spectral density: a band that a filter took away is seen with few,
/// and only with long ones.
const FEWEST_OF_POWER: usize = 4;
/// Where the content of a signal is its noise: this share of the spectrum, up to its end. A record
/// has no content of its own there: its anti-aliasing filter is below.
const TOP: f64 = 0.4;
/// It begins at so many times the end of the band, or content of the signal reaches into it.
const CLEAR: f64 = 5.0;
/// Largest shift between two signals that share content, as a share of their length.
const FARTHEST: f64 = 0.25;
/// Windows that overlap by half are not independent: so many of them count (Hann).
const INDEPENDENT: f64 = 0.9;

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
    let spectra = Spectra::of((simulated, measured), WINDOW, Trend::Mean)?;
    let lines = spectra.lines(rate, (low, high))?;
    let mut sum = 0.0;
    let count = lines.len();
    for line in lines {
        let one = spectra.coherence(line);
        if !one.is_finite() {
            return undefined("one of the signals has no content at a frequency of the band");
        }
        sum += one;
    }
    Ok(sum / count as f64)
}

/// The simulated and the measured signal, and the shift at which they agree best, once it is known.
pub type Both<'a> = (&'a [f64], &'a [f64], &'a OnceCell<isize>);

/// The share of the content of a band that both signals have in common, wherever one lies against
/// the other: 1 where one is made from the other, about 0 where they are independent, as two noises
/// are. It is the mean coherence at the best shift, less what unrelated signals have by chance.
///
/// # Errors
/// Fewer samples than eight windows; no spectral line in the band.
pub fn shared(of: Both<'_>, rate: f64, band: (f64, f64)) -> Metric {
    let spectra = Spectra::aligned(of, rate, band)?;
    let lines = spectra.lines(rate, band)?;
    let count = lines.len() as f64;
    Ok(lines.map(|line| spectra.beyond_chance(line)).sum::<f64>() / count)
}

/// What the other signal does not explain of a band: its share, times the ratio of its spectral
/// density there to that in the noise of the signal; the smaller one of both signals. The errors of
/// a model follow the signal, and are several times larger than its noise. What is left of a signal
/// that is the other one with noise is small, and as large in the band as anywhere.
///
/// # Errors
/// As [`shared`]; both signals are without noise.
pub fn unexplained(of: Both<'_>, rate: f64, band: (f64, f64)) -> Metric {
    if (1.0 - TOP) * rate / 2.0 < CLEAR * band.1 {
        return undefined("the sampling rate is too low to tell noise from the signal");
    }
    let spectra = Spectra::aligned(of, rate, band)?;
    let lines = spectra.lines(rate, band)?;
    let end = spectra.of_simulated.len();
    let top = ((1.0 - TOP) * end as f64) as usize..end;
    let mean = |lines: &Range<usize>, of: &dyn Fn(usize) -> f64| {
        lines.clone().map(of).sum::<f64>() / lines.len() as f64
    };
    let left = |line: usize| (1.0 - spectra.beyond_chance(line)).max(0.0);
    let ratio = |of: &[f64]| {
        mean(&lines, &|line| left(line) * of[line]) / mean(&top, &|line| left(line) * of[line])
    };
    // A signal without any noise has no ratio.
    let least = ratio(&spectra.of_simulated).min(ratio(&spectra.of_measured));
    if least.is_finite() {
        Ok(mean(&lines, &left) * least)
    } else {
        undefined("both signals are without noise")
    }
}

/// The smallest ratio of the spectral densities of two signals at a line of a band, of the smaller
/// one over the larger one: near 0 where one signal lacks what the other one has.
///
/// # Errors
/// Fewer samples than four windows of 32; no spectral line in the band; a signal without content.
pub fn least_ratio(of: (&[f64], &[f64]), rate: f64, band: (f64, f64)) -> Metric {
    let longest = 2 * of.0.len().min(of.1.len()) / (FEWEST_OF_POWER + 1);
    if longest < SHORTEST {
        return undefined("the section is too short for four windows");
    }
    let window = (longest / 2 + 1).next_power_of_two();
    let spectra = Spectra::of(of, window, Trend::Line)?;
    let mut least = 1.0_f64;
    for line in spectra.lines(rate, band)? {
        let (simulated, measured) = (spectra.of_simulated[line], spectra.of_measured[line]);
        if simulated.min(measured) <= 0.0 {
            return undefined("one of the signals has no content at a frequency of the band");
        }
        least = least.min((simulated / measured).min(measured / simulated));
    }
    Ok(least)
}

/// Spectra of two signals, summed over windows.
struct Spectra {
    window: usize,
    windows: usize,
    of_simulated: Vec<f64>,
    of_measured: Vec<f64>,
    of_both: Vec<Complex<f64>>,
}

impl Spectra {
    fn of(
        (simulated, measured): (&[f64], &[f64]),
        window: usize,
        trend: Trend,
    ) -> Result<Self, Undefined> {
        let windows = Windows::new(window, trend);
        let lines = window / 2 + 1;
        let mut all = Self {
            window,
            windows: 0,
            of_simulated: vec![0.0; lines],
            of_measured: vec![0.0; lines],
            of_both: vec![Complex::new(0.0, 0.0); lines],
        };
        // 50 % overlap.
        for start in windows.starts(simulated.len(), window / 2) {
            let (s, m) = (windows.lines(simulated, start)?, windows.lines(measured, start)?);
            for (line, (s, m)) in s.iter().zip(&m).enumerate() {
                all.of_simulated[line] += s.norm_sqr();
                all.of_measured[line] += m.norm_sqr();
                all.of_both[line] += s.conj() * m;
            }
            all.windows += 1;
        }
        Ok(all)
    }

    /// At the shift at which both agree best, with windows as long as the band needs.
    fn aligned(
        (simulated, measured, shift): Both<'_>,
        rate: f64,
        (low, high): (f64, f64),
    ) -> Result<Self, Undefined> {
        if shift.get().is_none() {
            let most = (FARTHEST * simulated.len() as f64) as usize;
            let found = best_shift(simulated, measured, most, Agreement::Correlation)?;
            shift.get_or_init(|| found);
        }
        let shift = shift.get().copied().unwrap_or_default();
        let (simulated, measured) = overlap(simulated, measured, shift);
        let wanted = (LINES * rate / (high - low)).ceil();
        let least = FEWEST * SHORTEST / 2;
        if simulated.len() < least || wanted * FEWEST as f64 / 2.0 > simulated.len() as f64 {
            return undefined("the section is too short for eight windows");
        }
        let window = (wanted as usize).next_power_of_two().max(SHORTEST);
        if window * (FEWEST + 1) / 2 > simulated.len() {
            return undefined("the section is too short for eight windows");
        }
        Self::of((simulated, measured), window, Trend::Line)
    }

    /// The lines with low <= f < high.
    fn lines(&self, rate: f64, (low, high): (f64, f64)) -> Result<Range<usize>, Undefined> {
        let apart = rate / self.window as f64;
        let mut all =
            (0..=self.window / 2).filter(|&line| (low..high).contains(&(line as f64 * apart)));
        let Some(first) = all.next() else {
            return undefined(format!(
                "no line of the spectrum lies in the band: the lines are {} apart",
                super::rounded(apart)
            ));
        };
        Ok(first..first + 1 + all.count())
    }

    fn coherence(&self, line: usize) -> f64 {
        self.of_both[line].norm_sqr() / (self.of_simulated[line] * self.of_measured[line])
    }

    /// The coherence less what unrelated signals have; 0 where a signal has no content.
    fn beyond_chance(&self, line: usize) -> f64 {
        let chance = 1.0 / (INDEPENDENT * self.windows as f64);
        let found = (self.coherence(line) - chance) / (1.0 - chance);
        if found.is_finite() { found } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::metrics::random::mixed;

    /// A band that one signal lacks, and white noise by itself: with few windows the lines scatter,
    /// not by more than two orders.
    #[test]
    fn a_missing_band_has_the_least_ratio() {
        let signal = noise(2_000, 7);
        let without = |low: f64, high: f64| {
            let count = signal.len();
            let forward = super::super::fourier::forward(count);
            let mut spectrum = forward.make_output_vec();
            forward.process(&mut signal.clone(), &mut spectrum).expect("a transform");
            // The band is 2 to 7 Hz at 200 samples per second: its part of the signal is taken away.
            (0..count)
                .map(|at| {
                    let lines = (low * 10.0) as usize..(high * 10.0) as usize;
                    let part = |k: usize| {
                        let turn = TAU * (k * at) as f64 / count as f64;
                        2.0 / count as f64
                            * (spectrum[k].re * turn.cos() - spectrum[k].im * turn.sin())
                    };
                    signal[at] - lines.map(part).sum::<f64>()
                })
                .collect::<Vec<f64>>()
        };
        let band = (1.0, 10.0);
        assert_eq!(least_ratio((&signal, &signal), 200.0, band), Ok(1.0));
        let lacking = least_ratio((&without(2.0, 7.0), &signal), 200.0, band).expect("a number");
        assert!(lacking < 0.001, "{lacking}");
        let unrelated = least_ratio((&noise(2_000, 8), &signal), 200.0, band).expect("a number");
        assert!(unrelated > 0.02, "{unrelated}");
        assert!(least_ratio((&signal[..60], &signal[..60]), 200.0, band).is_err());
        assert!(least_ratio((&[0.0; 500], &signal[..500]), 200.0, band).is_err());
    }

    /// White noise; seeds below 2^32 give independent ones.
    fn noise(count: usize, seed: u64) -> Vec<f64> {
        let at = |k: u64| mixed(mixed(seed << 32 | k)) >> 11;
        (0..count as u64).map(|k| at(k) as f64 / (1_u64 << 53) as f64 - 0.5).collect()
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

    /// Low-pass noise with errors of a model, and white noise of the measurement. Two steps of the
    /// filter leave nothing of the track above 60 Hz; one leaves more than the noise.
    fn sides(seed: u64) -> [Vec<f64>; 4] {
        let low_pass = |values: Vec<f64>| -> Vec<f64> {
            let mut state = 0.0;
            let step = |value: f64| {
                state += 0.1 * (value - state);
                state
            };
            values.into_iter().map(step).collect()
        };
        let slow = |seed| -> Vec<f64> {
            low_pass(low_pass(noise(4000, seed))).iter().map(|value| 32.0 * value).collect()
        };
        let (track, error) = (slow(seed), slow(seed + 1));
        let simulated: Vec<f64> = track.iter().zip(&error).map(|(a, b)| a + 0.5 * b).collect();
        let noises = [noise(4000, seed + 2), noise(4000, seed + 3)];
        let measured = track.iter().zip(&noises[0]).map(|(a, b)| a + b).collect();
        let [_, other] = noises;
        [simulated, measured, other, track]
    }

    #[test]
    fn what_is_made_of_a_measurement_shares_its_noise() {
        let [simulated, measured, other, _] = sides(7);
        let of = |s: &[f64]| {
            shared((s, &measured, &OnceCell::new()), 200.0, (60.0, 100.0)).expect("a number")
        };
        let with = |all: &[f64], by: f64| -> Vec<f64> {
            all.iter().zip(&other).map(|(a, b)| a + by * b).collect()
        };
        assert!(of(&with(&simulated, 1.0)).abs() < 0.05, "{}", of(&with(&simulated, 1.0)));
        assert!((of(&with(&measured, 1.0)) - 0.5).abs() < 0.1);
        // Delayed, scaled and blended with the simulation.
        let mut late = measured.clone();
        late.rotate_right(31);
        assert!(of(&late) > 0.99);
        let blended: Vec<f64> =
            measured.iter().zip(&simulated).map(|(m, s)| 0.3 * m + 0.7 * s).collect();
        assert!(of(&blended) > 0.5, "{}", of(&blended));
    }

    #[test]
    fn what_is_left_of_a_copy_is_white_and_the_error_of_a_model_is_not() {
        let [simulated, measured, other, track] = sides(11);
        let of = |s: &[f64], m: &[f64]| {
            unexplained((s, m, &OnceCell::new()), 200.0, (1.0, 10.0)).expect("a number")
        };
        assert!(of(&simulated, &measured) > 0.4, "{}", of(&simulated, &measured));
        let noisy = |all: &[f64]| -> Vec<f64> {
            all.iter().zip(&other).map(|(a, b)| 1.1 * a + 0.2 + b).collect()
        };
        assert!(of(&noisy(&measured), &measured) < 0.1, "{}", of(&noisy(&measured), &measured));
        assert!(of(&track, &noisy(&track)) < 0.1, "{}", of(&track, &noisy(&track)));
        let slowly = unexplained((&simulated, &measured, &OnceCell::new()), 100.0, (1.0, 10.0))
            .expect_err("too low");
        assert!(slowly.reason.contains("sampling rate"), "{slowly:?}");
    }

    #[test]
    fn a_short_section_says_so() {
        let a = noise(100, 1);
        let why = shared((&a, &a, &OnceCell::new()), 200.0, (60.0, 100.0)).expect_err("short");
        assert!(why.reason.contains("too short"), "{why:?}");
        let a = noise(4000, 1);
        assert!(shared((&a, &a, &OnceCell::new()), 100.0, (60.0, 100.0)).is_err());
    }
}
