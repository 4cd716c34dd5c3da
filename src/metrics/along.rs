//! A signal along its axis: derivative, integral, shifted signal.

use super::resample::{ResampleError, interpolate};

/// Slope at each sample, from the parabola through it and both neighbours; at the ends, the slope
/// to the one neighbour. `None` for fewer than two samples or lists of different length.
pub fn derivative(axis: &[f64], signal: &[f64]) -> Option<Vec<f64>> {
    let count = signal.len();
    if count < 2 || axis.len() != count {
        return None;
    }
    let slope = |from: usize| (signal[from + 1] - signal[from]) / (axis[from + 1] - axis[from]);
    let inside = |at: usize| {
        let (before, behind) = (axis[at] - axis[at - 1], axis[at + 1] - axis[at]);
        // For equal steps, this is the difference of both neighbours divided by two steps.
        (slope(at - 1) * behind + slope(at) * before) / (before + behind)
    };
    let slope_at = |at: usize| match at {
        0 => slope(0),
        at if at + 1 == count => slope(count - 2),
        at => inside(at),
    };
    Some((0..count).map(slope_at).collect())
}

/// Integral from the first sample on, by the trapezoidal rule.
pub fn integral(axis: &[f64], signal: &[f64]) -> Option<Vec<f64>> {
    if signal.is_empty() || axis.len() != signal.len() {
        return None;
    }
    let mut sum = 0.0;
    let parts =
        (1..signal.len()).map(|at| (axis[at] - axis[at - 1]) * (signal[at] + signal[at - 1]) / 2.0);
    let sums = std::iter::once(0.0).chain(parts).map(|part| {
        sum += part;
        sum
    });
    Some(sums.collect())
}

/// The signal moved forward by a distance, at the same points. Beyond the record, its end value is
/// used; callers must check that the record is long enough.
///
/// # Errors
/// As [`interpolate`].
pub fn moved(axis: &[f64], signal: &[f64], distance: f64) -> Result<Vec<f64>, ResampleError> {
    let (Some(&first), Some(&last)) = (axis.first(), axis.last()) else {
        return Err(ResampleError::Empty);
    };
    let points: Vec<f64> = axis.iter().map(|x| (x - distance).clamp(first, last)).collect();
    interpolate(axis, signal, &points)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis() -> Vec<f64> {
        (0..400).map(|k| 3.0 + 0.05 * f64::from(k) + 0.01 * f64::from(k % 3)).collect()
    }

    /// For a parabola, the slope is exact at every inner sample, also with unequal steps; at the
    /// ends it is the slope half a step inside.
    #[test]
    fn the_slope_of_a_parabola_is_exact_inside() {
        let axis = axis();
        let signal: Vec<f64> = axis.iter().map(|x| 2.0 * x * x - x).collect();
        let found = derivative(&axis, &signal).expect("samples");
        for at in 1..axis.len() - 1 {
            assert!((found[at] - (4.0 * axis[at] - 1.0)).abs() < 1e-9, "{at}");
        }
        assert!((found[0] - (2.0 * (axis[0] + axis[1]) - 1.0)).abs() < 1e-9);
        assert!(derivative(&[1.0], &[1.0]).is_none());
    }

    /// The trapezoidal rule is exact for a line; for a sine, its error is of second order in the
    /// step.
    #[test]
    fn the_integral_of_a_line_is_exact() {
        let axis = axis();
        let found = integral(&axis, &axis.iter().map(|x| 2.0 * x + 1.0).collect::<Vec<_>>())
            .expect("samples");
        for (x, value) in axis.iter().zip(&found) {
            assert!((value - (x * x + x - 12.0)).abs() < 1e-9);
        }
        let found =
            integral(&axis, &axis.iter().map(|x| x.sin()).collect::<Vec<_>>()).expect("samples");
        for (x, value) in axis.iter().zip(&found) {
            assert!((value - (axis[0].cos() - x.cos())).abs() < 1e-3);
        }
        // The slope of the integral is the signal, except for the interpolation between samples.
        assert!(integral(&[], &[]).is_none());
    }

    #[test]
    fn a_line_moved_is_the_line_elsewhere() {
        let axis = axis();
        let found = moved(&axis, &axis, 2.0).expect("an axis");
        for (x, value) in axis.iter().zip(&found) {
            assert!((value - (x - 2.0).max(axis[0])).abs() < 1e-12);
        }
    }
}
