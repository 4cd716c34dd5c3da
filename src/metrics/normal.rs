//! Quantiles of the normal distribution.

use statrs::distribution::{ContinuousCDF, Normal};

/// The value of a standard normal distribution that is not exceeded with this probability; `None`
/// for a probability not between 0 and 1.
pub fn normal_quantile(probability: f64) -> Option<f64> {
    if !(probability > 0.0 && probability < 1.0) {
        return None;
    }
    // The smaller tail keeps its digits.
    let tail = probability.min(1.0 - probability);
    let size = Normal::standard().inverse_cdf(tail).abs();
    Some(if probability < 0.5 { -size } else { size })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_agree_with_published_ones() {
        // `statistics.NormalDist().inv_cdf` of Python 3.
        for (probability, quantile) in [
            (0.5, 0.0),
            (0.95, 1.644_853_626_951_472_2),
            (0.975, 1.959_963_984_540_054),
            (1e-9, -5.997_807_015_007_687),
        ] {
            let found = normal_quantile(probability).expect("a probability");
            assert!((found - quantile).abs() < 1e-9, "{probability}: {found}");
        }
        assert_eq!(normal_quantile(0.0), None);
        assert_eq!(normal_quantile(1.0), None);
    }
}
