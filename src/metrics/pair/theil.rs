//! Theil's inequality coefficients and the proportions of the mean square error.
//!
//! Source: Theil, "Economic forecasts and policy" (1961) for U1 and the proportions, "Applied
//! economic forecasting" (1966) for U2.

use super::{Energies, Metric, Undefined, undefined};
use crate::metrics::{
    statistics::{Divisor, mean, standard_deviation},
    sum::sum_of_pairs,
};

/// Theil's U1: `rmse / (rms s + rms m)`, in [0, 1].
///
/// # Errors
/// Both signals are zero throughout.
pub fn theil_u1(simulated: &[f64], measured: &[f64]) -> Metric {
    let energies = Energies::of(simulated, measured)?;
    let sum = energies.simulated.sqrt() + energies.measured.sqrt();
    if sum == 0.0 {
        return undefined("both signals are zero throughout");
    }
    Ok(energies.difference.sqrt() / sum)
}

/// Theil's U2: `rmse / rms m`.
///
/// # Errors
/// The measurement is zero throughout.
pub fn theil_u2(simulated: &[f64], measured: &[f64]) -> Metric {
    let energies = Energies::of(simulated, measured)?;
    if energies.measured == 0.0 {
        return undefined("the measured signal is zero throughout");
    }
    Ok(energies.difference.sqrt() / energies.measured.sqrt())
}

/// Share of the mean square error from the difference of the means.
///
/// # Errors
/// The signals are equal, so that there is no error.
pub fn theil_bias(simulated: &[f64], measured: &[f64]) -> Metric {
    Proportions::of(simulated, measured).map(|proportions| proportions.bias)
}

/// Share of the mean square error from the difference of the standard deviations.
///
/// # Errors
/// The signals are equal, so that there is no error.
pub fn theil_variance(simulated: &[f64], measured: &[f64]) -> Metric {
    Proportions::of(simulated, measured).map(|proportions| proportions.variance)
}

/// Share of the mean square error from incomplete correlation.
///
/// # Errors
/// The signals are equal, so that there is no error.
pub fn theil_covariance(simulated: &[f64], measured: &[f64]) -> Metric {
    Proportions::of(simulated, measured).map(|proportions| proportions.covariance)
}

struct Proportions {
    bias: f64,
    variance: f64,
    covariance: f64,
}

impl Proportions {
    fn of(simulated: &[f64], measured: &[f64]) -> Result<Self, Undefined> {
        let energies = Energies::of(simulated, measured)?;
        let n = simulated.len() as f64;
        let mean_square_error = energies.difference / n;
        if mean_square_error == 0.0 {
            return undefined("the signals are equal");
        }
        let moments = |signal: &[f64]| {
            Some((mean(signal)?, standard_deviation(signal, Divisor::Population)?))
        };
        let (Some((mean_s, deviation_s)), Some((mean_m, deviation_m))) =
            (moments(simulated), moments(measured))
        else {
            return undefined("the sum of the samples overflows");
        };
        let covariance = if deviation_s > 0.0 && deviation_m > 0.0 {
            // 2 (sigma_s sigma_m - cov) as a sum of squares; the difference loses digits for well
            // correlated signals.
            let root = (deviation_m / deviation_s).sqrt();
            let term = |s: f64, m: f64| (s - mean_s) * root - (m - mean_m) / root;
            sum_of_pairs(simulated, measured, |s, m| term(s, m) * term(s, m)) / n
        } else {
            0.0
        };
        let share = |part: f64| part / mean_square_error;
        Ok(Self {
            bias: share((mean_s - mean_m).powi(2)),
            variance: share((deviation_s - deviation_m).powi(2)),
            covariance: share(covariance),
        })
    }
}
