//! Quartiles estimated from random selections, with distribution-free intervals.

use statrs::distribution::{Binomial, DiscreteCDF};

use crate::metrics::percentile::{Method, percentiles};
use crate::result::study::{Intervals, Spread};

/// Order statistics estimated from a random sample; nothing for an empty sample.
pub fn estimated(values: &[f64]) -> Option<Spread> {
    let found = percentiles(values, &[0.0, 25.0, 50.0, 75.0, 100.0], Method::Linear).ok()?;
    let [min, q1, median, q3, max] = found[..] else { return None };
    let reach = 1.5 * (q3 - q1);
    let outliers =
        values.iter().filter(|value| **value < q1 - reach || **value > q3 + reach).count() as u64;
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let intervals = [0.25, 0.5, 0.75].map(|share| interval(&sorted, share));
    let all = intervals.iter().all(Option::is_some);
    Some(Spread {
        min,
        q1,
        median,
        q3,
        max,
        outliers,
        count: values.len() as f64,
        exact: false,
        within: None,
        intervals: if all { intervals.into() } else { Intervals::default() },
    })
}

/// 95 % interval of a quantile from a sorted sample, for any distribution, between two order
/// statistics.
///
/// The number of values below the quantile is binomial. The interval lies between the order
/// statistics whose ranks this number exceeds and falls short of with 2.5 % each (David and
/// Nagaraja, "Order Statistics", 2003, section 7.1). `None` where the sample is too small to have
/// such ranks.
pub fn interval(sorted: &[f64], share: f64) -> Option<(f64, f64)> {
    let below = Binomial::new(share, sorted.len() as u64).ok()?;
    // Ranks from 1; P(count < low) and P(count >= high) are at most 2.5 % each.
    let low = below.inverse_cdf(0.025) as usize;
    let high = below.inverse_cdf(0.975) as usize + 1;
    (low >= 1 && high <= sorted.len()).then(|| (sorted[low - 1], sorted[high - 1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Conover, "Practical Nonparametric Statistics", tables of order statistics for the median: of
    /// 10 values the 2nd and the 9th, of 20 the 6th and the 15th, of 5 none.
    #[test]
    fn ranks_for_the_median_as_published() {
        let of = |n: usize| interval(&(1..=n).map(|k| k as f64).collect::<Vec<_>>(), 0.5);
        assert_eq!((of(10), of(20), of(5)), (Some((2.0, 9.0)), Some((6.0, 15.0)), None));
    }

    /// The coverage, summed from binomial probabilities, is never below 95 % and little above for a
    /// large sample.
    #[test]
    fn it_covers_what_it_says() {
        for (n, share, most) in [(30_u64, 0.25, 0.985), (200, 0.5, 0.97), (65_536, 0.75, 0.9515)] {
            let sorted: Vec<f64> = (1..=n).map(|k| k as f64).collect();
            let (low, high) = interval(&sorted, share).expect("large enough");
            let below = Binomial::new(share, n).expect("a distribution");
            // The quantile is inside if at least `low` and fewer than `high` values are below it.
            let covered = below.cdf(high as u64 - 1) - below.cdf(low as u64 - 1);
            assert!((0.95..most).contains(&covered), "{n} {share}: {covered}");
        }
    }
}
