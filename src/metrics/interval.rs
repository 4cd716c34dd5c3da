//! Confidence intervals, and that of a share. Those of means and standard deviations are in
//! `cluster`.

/// Lower and upper end of a confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    pub low: f64,
    pub high: f64,
}

/// 95 % interval of a share `good` of `all` (Wilson 1927); 0 to 1 if `all` is zero.
pub fn wilson(good: u64, all: u64) -> (f64, f64) {
    /// 97.5 % quantile of the normal distribution.
    const NORMAL: f64 = 1.959_963_984_540_054;
    if all == 0 {
        return (0.0, 1.0);
    }
    let (n, p) = (all as f64, good as f64 / all as f64);
    let square = NORMAL * NORMAL;
    let center = (p + square / (2.0 * n)) / (1.0 + square / n);
    let half = NORMAL / (1.0 + square / n) * (p * (1.0 - p) / n + square / (4.0 * n * n)).sqrt();
    // At the ends, both terms cancel except for rounding.
    (
        if good == 0 { 0.0 } else { (center - half).max(0.0) },
        if good == all { 1.0 } else { (center + half).min(1.0) },
    )
}
