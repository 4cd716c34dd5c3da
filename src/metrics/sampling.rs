//! How a signal was recorded: held values, saturation, quantisation.

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
