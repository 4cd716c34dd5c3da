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
    pub fn new(at: &[f64], values: Vec<f64>) -> Self {
        let n = at.len();
        let mut bends = vec![0.0; n];
        // The tridiagonal system of the second derivatives (Press et al., Numerical Recipes, 3.3),
        // natural ends.
        let mut right = vec![0.0; n];
        for i in 1..n.saturating_sub(1) {
            let share = (at[i] - at[i - 1]) / (at[i + 1] - at[i - 1]);
            let pivot = share * bends[i - 1] + 2.0;
            bends[i] = (share - 1.0) / pivot;
            let slopes = (values[i + 1] - values[i]) / (at[i + 1] - at[i])
                - (values[i] - values[i - 1]) / (at[i] - at[i - 1]);
            right[i] = (6.0 * slopes / (at[i + 1] - at[i - 1]) - share * right[i - 1]) / pivot;
        }
        let mut next = 0.0;
        for i in (0..n).rev() {
            bends[i] = if i == 0 || i + 1 == n { 0.0 } else { bends[i] * next + right[i] };
            next = bends[i];
        }
        Self { values, bends }
    }

    /// Coefficients of the powers 0 to 3 of the distance from point `i`, in the interval of length
    /// `width` after it.
    pub fn cubic(&self, i: usize, width: f64) -> [f64; 4] {
        let (low, high) = (self.values[i], self.values[i + 1]);
        let (low_bend, high_bend) = (self.bends[i], self.bends[i + 1]);
        let slope = (high - low) / width - width / 6.0 * (2.0 * low_bend + high_bend);
        [low, slope, 0.5 * low_bend, (high_bend - low_bend) / (6.0 * width)]
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
        // s(x) = 1.5 x - 0.5 x^3, then mirrored.
        let [c0, c1, c2, c3] = spline.cubic(0, 1.0);
        assert!(
            c0.abs() < 1e-14
                && (c1 - 1.5).abs() < 1e-14
                && c2.abs() < 1e-14
                && (c3 + 0.5).abs() < 1e-14
        );
        let [c0, c1, c2, c3] = spline.cubic(1, 1.0);
        assert!(
            (c0 - 1.0).abs() < 1e-14
                && c1.abs() < 1e-14
                && (c2 + 1.5).abs() < 1e-14
                && (c3 - 0.5).abs() < 1e-14
        );
    }
}
