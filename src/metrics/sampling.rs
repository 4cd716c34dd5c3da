//! How a signal was recorded: held values, saturation, quantisation, noise.

use super::statistics::median;

/// Share of the samples in the longest run of equal values: near 0 for a signal that varies, 1 for
/// a constant one.
///
/// `None` without samples.
pub fn longest_held_share(values: &[f64]) -> Option<f64> {
    let (mut longest, mut run) = (usize::from(!values.is_empty()), 1);
    // Without branches, which noise would make unpredictable.
    for [before, value] in values.array_windows() {
        run = if value == before { run + 1 } else { 1 };
        longest = longest.max(run);
    }
    // A single sample is not a run.
    let longest = if longest == 1 && values.len() > 1 { 0 } else { longest };
    (!values.is_empty()).then(|| longest as f64 / values.len() as f64)
}

/// Share of the samples at the smallest or at the largest value, the larger of both. It is large
/// for a saturated recorder.
///
/// `None` without samples, or with one that is not finite.
pub fn share_at_extreme(values: &[f64]) -> Option<f64> {
    let (least, greatest) = ends(values)?;
    let at = |end: f64| values.iter().map(|value| u64::from(*value == end)).sum::<u64>();
    Some(at(least).max(at(greatest)) as f64 / values.len() as f64)
}

/// The smallest change between consecutive samples, in their unit: the quantisation step of a
/// signal that varies; 0 for a constant one.
///
/// `None` without samples, or with one that is not finite.
pub fn resolution(values: &[f64]) -> Option<f64> {
    let (least, greatest) = ends(values)?;
    // Values with a fixed number of decimals differ by rounding of the last bit after conversion to
    // SI.
    let rounding = ROUNDING * least.abs().max(greatest.abs());
    let step = |before: f64, value: f64| (value - before).abs();
    let change = |before, value| {
        if step(before, value) > rounding { step(before, value) } else { f64::INFINITY }
    };
    let smallest = least_of(&values[..values.len() - 1], &values[1..], change);
    Some(if smallest < f64::INFINITY { smallest } else { 0.0 })
}

/// Standard deviation of white noise in a signal, from its fourth differences, which a signal of
/// less than a tenth of the sampling rate hardly has. Their median magnitude is used, so that steps
/// and shocks do not count.
///
/// `None` for fewer than nine samples, or with one that is not finite.
pub fn noise_floor(values: &[f64]) -> Option<f64> {
    /// Samples of which the median of the differences is taken at least.
    const LEAST: usize = 9;
    /// Standard deviation of the fourth difference of white noise: the root of 1 + 16 + 36 + 16 +
    /// 1.
    const OF_DIFFERENCE: f64 = 8.366_600_265_340_756;
    /// Median magnitude of a normal distribution.
    const MEDIAN: f64 = 0.674_489_750_196_082;
    ends(values).filter(|_| values.len() >= LEAST)?;
    let fourth = |[a, b, c, d, e]: &[f64; 5]| (a - 4.0 * b + 6.0 * c - 4.0 * d + e).abs();
    let differences: Vec<f64> = values.array_windows().map(fourth).collect();
    median(&differences).map(|middle| middle / (MEDIAN * OF_DIFFERENCE))
}

/// Relative to the largest value; smaller changes count as none.
const ROUNDING: f64 = 1e-12;

/// Smallest and largest value.
fn ends(values: &[f64]) -> Option<(f64, f64)> {
    // The loop checks all values without an early exit, which is faster.
    if values.is_empty() || !values.iter().fold(true, |all, value| all & value.is_finite()) {
        return None;
    }
    Some((least_of(values, values, |value, _| value), -least_of(values, values, |value, _| -value)))
}

/// The smallest `term` of two signals of equal length; infinite if there is none.
fn least_of(left: &[f64], right: &[f64], term: impl Fn(f64, f64) -> f64) -> f64 {
    let smaller = |a: f64, b: f64| if b < a { b } else { a };
    // Several minima side by side: no comparison waits for the one before.
    let mut lanes = [f64::INFINITY; 8];
    let ((left, left_rest), (right, right_rest)) = (left.as_chunks::<8>(), right.as_chunks::<8>());
    for (left, right) in left.iter().zip(right) {
        for lane in 0..8 {
            lanes[lane] = smaller(lanes[lane], term(left[lane], right[lane]));
        }
    }
    let rest = left_rest.iter().zip(right_rest).map(|(left, right)| term(*left, *right));
    rest.chain(lanes).fold(f64::INFINITY, smaller)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Noise of standard deviation 0.2 on a slow wave of amplitude 5; and neither a step nor a
    /// smooth signal has noise.
    #[test]
    fn noise_is_found_below_a_signal() {
        let mut state = 7_u64;
        let mut uniform = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let wave = |at: usize| 5.0 * (at as f64 * 0.05).sin() + if at > 900 { 30.0 } else { 0.0 };
        let noisy: Vec<f64> = (0..2000)
            .map(|at| wave(at) + 0.2 * ((0..12).map(|_| uniform()).sum::<f64>() - 6.0))
            .collect();
        let found = noise_floor(&noisy).expect("finite");
        assert!((found - 0.2).abs() < 0.02, "{found}");
        let smooth: Vec<f64> = (0..2000).map(wave).collect();
        assert!(noise_floor(&smooth).is_some_and(|floor| floor < 1e-4));
        assert_eq!(
            (noise_floor(&[1.0; 8]), noise_floor(&[1.0, f64::NAN]), noise_floor(&[3.0; 20])),
            (None, None, Some(0.0))
        );
    }

    /// The plain definitions, on signals of every length and with plateaus, ends and zeros of both
    /// signs.
    #[test]
    fn fast_loops_give_what_the_definitions_say() {
        let mut state = 3_u64;
        let mut value = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) % 7) as f64 * 0.25 - 0.75
        };
        for count in 1..70 {
            let values: Vec<f64> = (0..count).map(|_| value()).collect();
            let longest = values.chunk_by(|a, b| a == b).map(<[f64]>::len).max().expect("a sample");
            let longest = if longest == 1 && count > 1 { 0 } else { longest };
            assert_eq!(longest_held_share(&values), Some(longest as f64 / count as f64));
            let (least, greatest) = values
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
            let at = |end: f64| values.iter().filter(|value| **value == end).count();
            assert_eq!(
                share_at_extreme(&values),
                Some(at(least).max(at(greatest)) as f64 / count as f64)
            );
            let steps =
                values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > 1e-9);
            assert_eq!(
                resolution(&values),
                Some(steps.fold(f64::INFINITY, f64::min)).map(|step| if step < 1.0 / 0.0 {
                    step
                } else {
                    0.0
                })
            );
            let mut damaged = values.clone();
            damaged[count / 2] = f64::NAN;
            assert_eq!((share_at_extreme(&damaged), resolution(&damaged)), (None, None));
        }
    }

    #[test]
    fn by_hand() {
        assert_eq!(longest_held_share(&[1.0, 1.0, 1.0, 2.0, 2.0]), Some(0.6));
        assert_eq!(longest_held_share(&[1.0, 2.0, 3.0, 4.0]), Some(0.0));
        assert_eq!(longest_held_share(&[7.0; 9]), Some(1.0));
        assert_eq!(share_at_extreme(&[-1.0, 0.5, 2.0, 2.0, 2.0, 0.0]), Some(0.5));
        assert_eq!(resolution(&[0.5, 1.0, 0.75, 1.25]), Some(0.25));
        assert_eq!(resolution(&[3.0, 3.0]), Some(0.0));
        assert_eq!(
            (longest_held_share(&[]), share_at_extreme(&[]), resolution(&[f64::NAN])),
            (None, None, None)
        );
    }

    /// Values with two decimals in kN, converted to N: steps of 10 N in spite of rounding.
    #[test]
    fn steps_survive_the_change_of_unit() {
        let values: Vec<f64> =
            (0..500).map(|k| f64::from(k * k * 7 % 101) * 0.01 * 1000.0 + 54_540.0).collect();
        let found = resolution(&values).expect("finite");
        assert!((found - 10.0).abs() < 1e-6, "{found}");
    }
}
