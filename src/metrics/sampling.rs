//! How a signal was recorded: values that stand still, ends of the range, steps of quantisation.

/// Share of the samples that the longest run of equal values takes: near 0 for a live signal, 1 for one that never changes.
///
/// `None` without samples.
pub fn longest_held_share(values: &[f64]) -> Option<f64> {
    let longest = values.chunk_by(|a, b| a == b).map(<[f64]>::len).max()?;
    // A single sample holds nothing.
    let longest = if longest == 1 && values.len() > 1 { 0 } else { longest };
    Some(longest as f64 / values.len() as f64)
}

/// Share of the samples that lie at the end of the range where more of them lie: large where a recorder was driven to its limit.
///
/// `None` without samples, or with one that is not finite.
pub fn share_at_extreme(values: &[f64]) -> Option<f64> {
    let (least, greatest) = ends(values)?;
    let at = |end: f64| values.iter().filter(|value| **value == end).count();
    Some(at(least).max(at(greatest)) as f64 / values.len() as f64)
}

/// The smallest change from one sample to the next that is one: the step of quantisation of a live signal, in its unit; 0 for a constant.
///
/// `None` without samples, or with one that is not finite.
pub fn resolution(values: &[f64]) -> Option<f64> {
    let (least, greatest) = ends(values)?;
    // Values written with a fixed number of decimals differ by rounding of the last bit when they are turned into SI.
    let rounding = ROUNDING * least.abs().max(greatest.abs());
    let steps = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > rounding);
    Some(steps.reduce(f64::min).unwrap_or(0.0))
}

/// Relative to the largest value: changes below it are none.
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

    /// Values with two decimals in kN, read into N: steps of 10 N, whatever the rounding.
    #[test]
    fn steps_survive_the_change_of_unit() {
        let values: Vec<f64> = (0..500).map(|k| f64::from(k * k * 7 % 101) * 0.01 * 1000.0 + 54_540.0).collect();
        let found = resolution(&values).expect("finite");
        assert!((found - 10.0).abs() < 1e-6, "{found}");
    }
}
