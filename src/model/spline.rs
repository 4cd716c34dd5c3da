//! Natural cubic splines.

/// A natural cubic spline through points with increasing abscissae.
#[derive(Clone, Debug)]
pub struct Spline {
    values: Vec<f64>,
    /// Second derivatives at the points.
    bends: Vec<f64>,
}

impl Spline {
    /// Two or more points; `at` strictly increasing, of the length of `values`.
    #[must_use]
    pub fn new(at: &[f64], values: Vec<f64>) -> Self {
        let n = at.len();
        let mut bends = vec![0.0; n];
        // The tridiagonal system of the second derivatives (Press et al., Numerical Recipes, 3.3), natural ends.
        let mut right = vec![0.0; n];
        for i in 1..n.saturating_sub(1) {
            let share = (at[i] - at[i - 1]) / (at[i + 1] - at[i - 1]);
            let pivot = share * bends[i - 1] + 2.0;
            bends[i] = (share - 1.0) / pivot;
            let slopes = (values[i + 1] - values[i]) / (at[i + 1] - at[i]) - (values[i] - values[i - 1]) / (at[i] - at[i - 1]);
            right[i] = (6.0 * slopes / (at[i + 1] - at[i - 1]) - share * right[i - 1]) / pivot;
        }
        let mut next = 0.0;
        for i in (0..n).rev() {
            bends[i] = if i == 0 || i + 1 == n { 0.0 } else { bends[i] * next + right[i] };
            next = bends[i];
        }
        Self { values, bends }
    }

    /// Value and slope in the interval from point `i`, which has `width`, at `share` (0 to 1) of it.
    #[inline]
    #[must_use]
    pub fn at(&self, i: usize, width: f64, share: f64) -> (f64, f64) {
        let (b, a) = (share, 1.0 - share);
        let (low, high) = (self.values[i], self.values[i + 1]);
        let (low_bend, high_bend) = (self.bends[i], self.bends[i + 1]);
        let sixth = width / 6.0;
        let value = a * low + b * high + ((a * a * a - a) * low_bend + (b * b * b - b) * high_bend) * width * sixth;
        let slope = (high - low) / width + ((3.0 * b * b - 1.0) * high_bend - (3.0 * a * a - 1.0) * low_bend) * sixth;
        (value, slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A natural spline through x^3 on 0..2 with free ends: closed form of three points.
    #[test]
    fn three_points_by_hand() {
        let spline = Spline::new(&[0.0, 1.0, 2.0], vec![0.0, 1.0, 0.0]);
        // Second derivative in the middle: 4 M = 6 (-1 - 1), M = -3.
        assert!((spline.bends[1] + 3.0).abs() < 1e-14);
        let (value, slope) = spline.at(0, 1.0, 0.5);
        // s(x) = 1.5 x - 0.5 x^3.
        assert!((value - 0.6875).abs() < 1e-14 && (slope - 1.125).abs() < 1e-14);
        assert!((spline.at(1, 1.0, 0.5).0 - 0.6875).abs() < 1e-14);
    }
}
