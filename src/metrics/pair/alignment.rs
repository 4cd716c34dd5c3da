//! Whether two records of one run lie alike along the axis: shifted, mirrored, drifting apart.

use super::{Undefined, check};
use crate::metrics::resample::{interpolate, uniform_grid};
use crate::metrics::statistics;

/// Points of the grid on which a shift is looked for; the steps between them are refined by a parabola.
const GRID: f64 = 256.0;
/// The farthest shift looked for, as a share of the stretch compared: so much of it is always left to compare.
const FARTHEST: f64 = 0.25;
/// Signals whose best correlation is below this follow each other at no shift. Between unrelated stretches of 250 m with waves of
/// 10 m (25 waves) the best of some 50 independent shifts is seldom above 0.5.
const FOLLOWS: f64 = 0.5;

/// What is to be added to the measured axis so that the measured signal follows the simulated one best, in the unit of the axis.
///
/// The correlation is taken where both overlap, at every shift up to a quarter of the stretch.
///
/// # Errors
/// The signals follow each other at no shift, or best at the end of what is looked at; an axis that does not increase.
pub fn shift(axis: &[f64], simulated: &[f64], measured: &[f64]) -> Result<f64, Undefined> {
    check(simulated, measured)?;
    let no_axis = || Undefined::because("the samples do not follow each other along the axis");
    let (Some(first), Some(last)) = (axis.first(), axis.last()) else { return Err(no_axis()) };
    let step = (last - first) / GRID;
    let grid = uniform_grid(*first, *last, step).map_err(|_| no_axis())?;
    let on_grid = |signal: &[f64]| interpolate(axis, signal, &grid).map_err(|_| no_axis());
    let (s, m) = (on_grid(simulated)?, on_grid(measured)?);
    let most = (FARTHEST * GRID) as usize;
    // Ahead: the measured signal at a smaller place shows what the simulated one shows further on.
    let ahead = |lag: usize| statistics::correlation(&s[lag..], &m[..m.len() - lag]);
    let behind = |lag: usize| statistics::correlation(&s[..s.len() - lag], &m[lag..]);
    let all: Vec<f64> = (1..=most).rev().map(behind).chain((0..=most).map(ahead)).map(|found| found.unwrap_or(f64::NEG_INFINITY)).collect();
    let best = (0..all.len()).fold(0, |best, at| if all[at] > all[best] { at } else { best });
    if all[best] < FOLLOWS {
        return Err(Undefined::because("the signals follow each other at no shift"));
    }
    if best == 0 || best + 1 == all.len() {
        return Err(Undefined::because("the best shift lies at the end of what is looked at"));
    }
    let (before, at, after) = (all[best - 1], all[best], all[best + 1]);
    let curvature = before - 2.0 * at + after;
    let refined = if curvature < 0.0 { 0.5 * (before - after) / curvature } else { 0.0 };
    Ok((best as f64 - most as f64 + refined) * step)
}

/// Correlation of the measured signal with the simulated one read from its end: near 1 where one of the records is mirrored.
///
/// # Errors
/// A signal is constant.
pub fn mirrored_correlation(simulated: &[f64], measured: &[f64]) -> Result<f64, Undefined> {
    let mirrored: Vec<f64> = simulated.iter().rev().copied().collect();
    super::correlation(&mirrored, measured)
}

/// By how much the measured signal drifts away from the simulated one from the first to the last sample, in the unit of the
/// signals: the regression line of their difference, measured less simulated.
///
/// # Errors
/// Fewer than two samples.
pub fn drift(axis: &[f64], simulated: &[f64], measured: &[f64]) -> Result<f64, Undefined> {
    check(simulated, measured)?;
    let difference: Vec<f64> = measured.iter().zip(simulated).map(|(m, s)| m - s).collect();
    let line = statistics::regression(axis, &difference).ok_or_else(|| Undefined::because("there are fewer than two samples"))?;
    let length = axis.last().unwrap_or(&0.0) - axis.first().unwrap_or(&0.0);
    Ok(line.slope * length)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    fn track(x: f64) -> f64 {
        (TAU * x / 7.3).sin() + 0.6 * (TAU * x / 19.1 + 1.0).sin() + 0.4 * (TAU * x / 31.7 + 2.0).cos()
    }

    /// A measurement that reads 3.2 m too little shows at x what is simulated at x + 3.2 m.
    #[test]
    fn a_known_shift_is_found() {
        let axis: Vec<f64> = (0..1000).map(|k| 100.0 + 0.2 * f64::from(k)).collect();
        let simulated: Vec<f64> = axis.iter().map(|x| track(*x)).collect();
        for known in [3.2, -5.7, 0.0, 21.0] {
            let measured: Vec<f64> = axis.iter().map(|x| track(x + known)).collect();
            let found = shift(&axis, &simulated, &measured).expect("they follow");
            assert!((found - known).abs() < 0.05, "{found}, made with {known}");
        }
    }

    #[test]
    fn what_does_not_follow_has_no_shift() {
        let axis: Vec<f64> = (0..1000).map(|k| 0.2 * f64::from(k)).collect();
        let simulated: Vec<f64> = axis.iter().map(|x| track(*x)).collect();
        let mut state = 7_u64;
        let noise: Vec<f64> = (0..1000)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 33) as f64
            })
            .collect();
        assert!(shift(&axis, &simulated, &noise).is_err());
        assert!(shift(&axis, &simulated, &vec![1.0; 1000]).is_err());
        assert!(shift(&[], &[], &[]).is_err());
    }

    #[test]
    fn a_mirrored_record_is_told() {
        let axis: Vec<f64> = (0..1000).map(|k| 0.2 * f64::from(k)).collect();
        let simulated: Vec<f64> = axis.iter().map(|x| track(*x)).collect();
        let measured: Vec<f64> = simulated.iter().rev().copied().collect();
        assert!((mirrored_correlation(&simulated, &measured).expect("varies") - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_line_added_is_the_drift() {
        let axis: Vec<f64> = (0..=200).map(f64::from).collect();
        let simulated: Vec<f64> = axis.iter().map(|x| track(*x)).collect();
        let measured: Vec<f64> = axis.iter().zip(&simulated).map(|(x, s)| s + 4.0 + 0.01 * x).collect();
        assert!((drift(&axis, &simulated, &measured).expect("a line") - 2.0).abs() < 1e-9);
    }
}
