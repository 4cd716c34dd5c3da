//! How a signal was recorded: held values, saturation, quantisation, noise.

use super::statistics::median;

/// Share of the samples in the longest run of equal values: near 0 for a signal that varies, 1 for a constant one.
///
/// `None` without samples.
pub fn longest_held_share(values: &[f64]) -> Option<f64> {
    let longest = values.chunk_by(|a, b| a == b).map(<[f64]>::len).max()?;
    // A single sample is not a run.
    let longest = if longest == 1 && values.len() > 1 { 0 } else { longest };
    Some(longest as f64 / values.len() as f64)
}

/// Share of the samples at the smallest or at the largest value, the larger of both. It is large for a saturated recorder.
///
/// `None` without samples, or with one that is not finite.
pub fn share_at_extreme(values: &[f64]) -> Option<f64> {
    let (least, greatest) = ends(values)?;
    let at = |end: f64| values.iter().filter(|value| **value == end).count();
    Some(at(least).max(at(greatest)) as f64 / values.len() as f64)
}

/// The smallest change between consecutive samples, in their unit: the quantisation step of a signal that varies; 0 for a constant
/// one.
///
/// `None` without samples, or with one that is not finite.
pub fn resolution(values: &[f64]) -> Option<f64> {
    let (least, greatest) = ends(values)?;
    // Values with a fixed number of decimals differ by rounding of the last bit after conversion to SI.
    let rounding = ROUNDING * least.abs().max(greatest.abs());
    let steps = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > rounding);
    Some(steps.reduce(f64::min).unwrap_or(0.0))
}

/// Standard deviation of white noise in a signal, from its fourth differences, which a signal of less than a tenth of the sampling rate
/// hardly has. Their median magnitude is used, so that steps and shocks do not count.
///
/// `None` for fewer than nine samples, or with one that is not finite.
pub fn noise_floor(values: &[f64]) -> Option<f64> {
    /// Samples of which the median of the differences is taken at least.
    const LEAST: usize = 9;
    /// Standard deviation of the fourth difference of white noise: the root of 1 + 16 + 36 + 16 + 1.
    const OF_DIFFERENCE: f64 = 8.366_600_265_340_756;
    /// Median magnitude of a normal distribution.
    const MEDIAN: f64 = 0.674_489_750_196_082;
    ends(values).filter(|_| values.len() >= LEAST)?;
    let fourth = |part: &[f64]| (part[0] - 4.0 * part[1] + 6.0 * part[2] - 4.0 * part[3] + part[4]).abs();
    let differences: Vec<f64> = values.windows(5).map(fourth).collect();
    median(&differences).map(|middle| middle / (MEDIAN * OF_DIFFERENCE))
}

/// Relative to the largest value; smaller changes count as none.
const ROUNDING: f64 = 1e-12;

fn ends(values: &[f64]) -> Option<(f64, f64)> {
    if values.is_empty() || values.iter().any(|value| !value.is_finite()) {
        return None;
    }
    Some(values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(*value), high.max(*value))))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Noise of standard deviation 0.2 on a slow wave of amplitude 5; and neither a step nor a smooth signal has noise.
    #[test]
    fn noise_is_found_below_a_signal() {
        let mut state = 7_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let wave = |at: usize| 5.0 * (at as f64 * 0.05).sin() + if at > 900 { 30.0 } else { 0.0 };
        let noisy: Vec<f64> = (0..2000).map(|at| wave(at) + 0.2 * ((0..12).map(|_| uniform()).sum::<f64>() - 6.0)).collect();
        let found = noise_floor(&noisy).expect("finite");
        assert!((found - 0.2).abs() < 0.02, "{found}");
        let smooth: Vec<f64> = (0..2000).map(wave).collect();
        assert!(noise_floor(&smooth).is_some_and(|floor| floor < 1e-4));
        assert_eq!((noise_floor(&[1.0; 8]), noise_floor(&[1.0, f64::NAN]), noise_floor(&[3.0; 20])), (None, None, Some(0.0)));
    }

    #[test]
    fn by_hand() {
        assert_eq!(longest_held_share(&[1.0, 1.0, 1.0, 2.0, 2.0]), Some(0.6));
        assert_eq!(longest_held_share(&[1.0, 2.0, 3.0, 4.0]), Some(0.0));
        assert_eq!(longest_held_share(&[7.0; 9]), Some(1.0));
        assert_eq!(share_at_extreme(&[-1.0, 0.5, 2.0, 2.0, 2.0, 0.0]), Some(0.5));
        assert_eq!(resolution(&[0.5, 1.0, 0.75, 1.25]), Some(0.25));
        assert_eq!(resolution(&[3.0, 3.0]), Some(0.0));
        assert_eq!((longest_held_share(&[]), share_at_extreme(&[]), resolution(&[f64::NAN])), (None, None, None));
    }

    /// Values with two decimals in kN, converted to N: steps of 10 N in spite of rounding.
    #[test]
    fn steps_survive_the_change_of_unit() {
        let values: Vec<f64> = (0..500).map(|k| f64::from(k * k * 7 % 101) * 0.01 * 1000.0 + 54_540.0).collect();
        let found = resolution(&values).expect("finite");
        assert!((found - 10.0).abs() < 1e-6, "{found}");
    }
}
