//! Levels and slopes that single outliers do not change, with intervals.
//!
//! Sources: Theil (1950), Sen, "Estimates of the regression coefficient based on Kendall's tau",
//! JASA 63 (1968); McGill, Tukey and Larsen, "Variations of box plots", The American Statistician 32
//! (1978).

use super::{
    percentile::{Method, percentile},
    statistics::median,
};

/// Quantile of the normal distribution of a two-sided interval of 99 %: some hundred intervals are
/// looked at in one campaign.
const QUANTILE: f64 = 2.576;
/// Standard error of a median over the interquartile range and the root of the number of values
/// (normal distribution): 1.2533 / 1.349.
const OF_QUARTILES: f64 = 0.929;

/// A number with its interval of 99 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    pub value: f64,
    pub low: f64,
    pub high: f64,
}

/// The median of some values; `None` of none.
pub fn level(values: &[f64]) -> Option<Estimate> {
    let value = median(values)?;
    let at = |percent: f64| percentile(values, percent, Method::Linear).ok();
    let half = QUANTILE * OF_QUARTILES * (at(75.0)? - at(25.0)?) / (values.len() as f64).sqrt();
    Some(Estimate { value, low: value - half, high: value + half })
}

/// The median slope of y over x of all pairs of points; `None` where no two points differ in x.
pub fn slope(x: &[f64], y: &[f64]) -> Option<Estimate> {
    let points: Vec<(f64, f64)> = x.iter().copied().zip(y.iter().copied()).collect();
    let mut slopes: Vec<f64> = Vec::new();
    for (at, (x, y)) in points.iter().enumerate() {
        let others = points[at + 1..].iter().filter(|(other, _)| other != x);
        slopes.extend(others.map(|(x2, y2)| (y2 - y) / (x2 - x)));
    }
    let value = median(&slopes)?;
    slopes.sort_unstable_by(f64::total_cmp);
    let (count, pairs) = (points.len() as f64, slopes.len() as f64);
    let spread = QUANTILE * (count * (count - 1.0) * (2.0 * count + 5.0) / 18.0).sqrt();
    let at = |rank: f64| slopes[(rank.max(0.0) as usize).min(slopes.len() - 1)];
    let low = at(((pairs - spread) / 2.0).floor());
    let high = at(((pairs + spread) / 2.0).ceil());
    Some(Estimate { value, low, high })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outlier_changes_neither() {
        let x: Vec<f64> = (0..15).map(f64::from).collect();
        let mut y: Vec<f64> = x.iter().map(|x| 2.0 * x + 1.0 + 0.1 * (7.0 * x).sin()).collect();
        y[3] = 500.0;
        let found = slope(&x, &y).expect("a slope");
        assert!((found.value - 2.0).abs() < 0.02, "{found:?}");
        assert!(found.low > 1.9 && found.high < 2.2 && found.low < found.value, "{found:?}");
        let rest: Vec<f64> = x.iter().zip(&y).map(|(x, y)| y - 2.0 * x).collect();
        let found = level(&rest).expect("a level");
        assert!((found.value - 1.0).abs() < 0.1 && found.high - found.low < 0.3, "{found:?}");
    }

    /// The same numbers as `scipy.stats.theilslopes([1, 3, 2, 5, 4, 8], range(6), 0.99)`: 1.25, and
    /// the smallest and the largest slope.
    #[test]
    fn slopes_are_those_of_scipy() {
        let found = slope(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0], &[1.0, 3.0, 2.0, 5.0, 4.0, 8.0]);
        let found = found.expect("a slope");
        assert_eq!((found.value, found.low, found.high), (1.25, -1.0, 4.0));
        assert_eq!(slope(&[1.0; 6], &[1.0; 6]), None);
    }
}
