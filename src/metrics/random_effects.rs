//! Random-effects model: the variance between estimates of the same number, in addition to their
//! own variances.

/// The variance between estimates (Paule and Mandel, "Consensus values and weighting factors",
/// 1982). With it, the sum of squares about the weighted mean, with weights 1 / (own variance +
/// variance between), has its expected value n - 1. It is zero if the sum of squares is not larger
/// without it.
///
/// `None` for fewer than two estimates or another number of variances.
pub fn between(estimates: &[f64], variances: &[f64]) -> Option<f64> {
    let count = estimates.len();
    if count < 2 || variances.len() != count {
        return None;
    }
    let widest =
        estimates.iter().fold(0.0_f64, |widest, one| widest.max((one - estimates[0]).abs()));
    // With zero variances, all weights are equal.
    let least = 1e-12 * widest * widest + 1e-30;
    let too_many = |common: f64| {
        let weights: Vec<f64> = variances.iter().map(|own| 1.0 / (own + common + least)).collect();
        let mean = estimates.iter().zip(&weights).map(|(one, weight)| weight * one).sum::<f64>()
            / weights.iter().sum::<f64>();
        estimates
            .iter()
            .zip(&weights)
            .map(|(one, weight)| weight * (one - mean).powi(2))
            .sum::<f64>()
            > (count - 1) as f64
    };
    if !too_many(0.0) {
        return Some(0.0);
    }
    // The sum of squares decreases with the variance between. At four times the square of the range
    // it is certainly below n - 1.
    let (mut low, mut high) = (0.0, 4.0 * widest * widest);
    for _ in 0..100 {
        let middle = f64::midpoint(low, high);
        if too_many(middle) { low = middle } else { high = middle }
    }
    Some(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Viechtbauer, "Conducting meta-analyses in R with the metafor package" (2010): 13 trials of a
    /// vaccine, logarithms of risk ratios. The Paule-Mandel estimate is 0.3181.
    #[test]
    fn trials_as_published() {
        let trials = [
            -0.8893, -1.5854, -1.3481, -1.4416, -0.2175, -0.7861, -1.6209, 0.0120, -0.4694,
            -1.3713, -0.3394, 0.4459, -0.0173,
        ];
        let own = [
            0.3256, 0.1946, 0.4154, 0.0200, 0.0512, 0.0069, 0.2230, 0.0040, 0.0564, 0.0730, 0.0124,
            0.5325, 0.0714,
        ];
        let found = between(&trials, &own).expect("estimates");
        assert!((found - 0.3181).abs() < 1e-4, "{found}");
    }

    /// With equal variances, it is the variance of the estimates minus their own variance.
    #[test]
    fn equal_variances_are_taken_off() {
        // The sum of squares about the mean 3.5 is 21; divided by 3 it is 7.
        let found = between(&[1.0, 2.0, 4.0, 7.0], &[0.5; 4]).expect("estimates");
        assert!((found - 6.5).abs() < 1e-9, "{found}");
        assert_eq!(between(&[1.0, 1.1, 0.9], &[3.0; 3]), Some(0.0));
        assert_eq!(between(&[1.0; 3], &[0.0; 3]), Some(0.0));
        assert_eq!((between(&[1.0], &[1.0]), between(&[1.0; 2], &[1.0])), (None, None));
    }
}
