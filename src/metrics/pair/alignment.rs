//! Alignment of two records along the axis: shift, mirroring, drift.

use super::{
    Metric, Undefined, check,
    lag::{Agreement, agreements},
    undefined,
};
use crate::metrics::{
    resample::{interpolate, uniform_grid},
    statistics,
};

/// Number of grid points of the search for a shift; a parabola refines the result between them.
const GRID: f64 = 256.0;
/// Largest shift, as a share of the compared range, so that most of the range is always compared.
const FARTHEST: f64 = 0.25;
/// If the largest correlation is below this, the signals are not related at any shift. For
/// unrelated ranges of 250 m with wavelengths of 10 m (25 waves), the largest correlation at about
/// 50 independent shifts is seldom above 0.5.
const FOLLOWS: f64 = 0.5;
/// Two errors of a correlation r over 25 waves, as a share of 1 - r^2: the error is (1 - r^2) /
/// sqrt(25). Agreement at two shifts that differs by less is that of chance, and the nearer shift
/// counts. A body that sways has nearly equal waves, and agrees again one wave farther.
const BY_CHANCE: f64 = 0.4;

/// Shift to be added to the measured axis for the largest correlation with the simulated signal, in
/// the unit of the axis.
///
/// The correlation is computed over the overlap, for every shift up to a quarter of the range.
///
/// # Errors
/// The signals are not related at any shift; the best shift is at the end of the search range; an
/// axis that does not increase.
pub fn shift(axis: &[f64], simulated: &[f64], measured: &[f64]) -> Metric {
    check(simulated, measured)?;
    let no_axis = || Undefined::because("the axis does not increase");
    let (Some(first), Some(last)) = (axis.first(), axis.last()) else { return Err(no_axis()) };
    let step = (last - first) / GRID;
    let grid = uniform_grid(*first, *last, step).map_err(|_| no_axis())?;
    let on_grid = |signal: &[f64]| interpolate(axis, signal, &grid).map_err(|_| no_axis());
    let (s, m) = (on_grid(simulated)?, on_grid(measured)?);
    let most = (FARTHEST * GRID) as usize;
    let all = agreements(&s, &m, most, Agreement::Correlation)?;
    let best = (0..all.len()).fold(0, |best, at| if all[at] > all[best] { at } else { best });
    if all[best] < FOLLOWS {
        return undefined("the signals are not correlated at any shift");
    }
    let peak = |at: &usize| all[at - 1] <= all[*at] && all[at + 1] <= all[*at];
    let least = all[best] - BY_CHANCE * (1.0 - all[best].powi(2));
    let nearest = (1..all.len() - 1)
        .filter(|at| all[*at] > least)
        .filter(peak)
        .min_by_key(|at| at.abs_diff(most));
    let best = nearest.unwrap_or(best);
    if best == 0 || best + 1 == all.len() {
        return undefined("the best shift is at the end of the search range");
    }
    let (before, at, after) = (all[best - 1], all[best], all[best + 1]);
    let curvature = before - 2.0 * at + after;
    let refined = if curvature < 0.0 { 0.5 * (before - after) / curvature } else { 0.0 };
    Ok((best as f64 - most as f64 + refined) * step)
}

/// Correlation of the measured signal with the simulated one in reverse order; near 1 if one of the
/// records is mirrored.
///
/// # Errors
/// A signal is constant.
pub fn mirrored_correlation(simulated: &[f64], measured: &[f64]) -> Metric {
    let mirrored: Vec<f64> = simulated.iter().rev().copied().collect();
    super::correlation(&mirrored, measured)
}

/// Drift of the measured signal from the simulated one between the first and the last sample, in
/// the unit of the signals: the change of the regression line of measured minus simulated.
///
/// # Errors
/// Fewer than two samples.
pub fn drift(axis: &[f64], simulated: &[f64], measured: &[f64]) -> Metric {
    check(simulated, measured)?;
    let difference: Vec<f64> = measured.iter().zip(simulated).map(|(m, s)| m - s).collect();
    let line = statistics::regression(axis, &difference)
        .ok_or_else(|| Undefined::because("there are fewer than two samples"))?;
    let length = axis.last().unwrap_or(&0.0) - axis.first().unwrap_or(&0.0);
    Ok(line.slope * length)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    fn track(x: f64) -> f64 {
        (TAU * x / 7.3).sin()
            + 0.6 * (TAU * x / 19.1 + 1.0).sin()
            + 0.4 * (TAU * x / 31.7 + 2.0).cos()
    }

    /// A measured coordinate that is 3.2 m too small shows at x the simulated value at x + 3.2 m.
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
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                (state >> 33) as f64
            })
            .collect();
        assert!(shift(&axis, &simulated, &noise).is_err());
        assert!(shift(&axis, &simulated, &vec![1.0; 1000]).is_err());
        assert!(shift(&[], &[], &[]).is_err());
    }

    /// Waves that are nearly equal agree again some waves farther; here even better, by chance.
    #[test]
    fn of_equal_waves_the_nearest_counts() {
        let axis: Vec<f64> = (0..1500).map(|k| 0.2 * f64::from(k)).collect();
        let wave = |at: f64| (at / 3.0).sin();
        let simulated: Vec<f64> = axis.iter().map(|x| wave(*x) + 0.5 * (1.7 * x).sin()).collect();
        // The last waves are larger: three waves farther, they are not in the overlap.
        let grown = |x: f64| if x > 260.0 { 3.0 } else { 1.0 };
        let measured: Vec<f64> =
            axis.iter().map(|x| grown(*x) * wave(x + 1.0) + 0.5 * (2.3 * x).sin()).collect();
        let found = shift(&axis, &simulated, &measured).expect("related");
        assert!((found - 1.0).abs() < 0.5, "{found}");
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
        let measured: Vec<f64> =
            axis.iter().zip(&simulated).map(|(x, s)| s + 4.0 + 0.01 * x).collect();
        assert!((drift(&axis, &simulated, &measured).expect("a line") - 2.0).abs() < 1e-9);
    }
}
