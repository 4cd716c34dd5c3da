//! Metrics of the difference of the signals, sample by sample.

use super::{Energies, Metric, Undefined, check, undefined};
use crate::metrics::{statistics, sum::sum_of_pairs};

/// Root mean square of simulation minus measurement, in the unit of the signals.
///
/// # Errors
/// Signals of different length, without samples, or with a sample that is not finite. This applies
/// to every metric of this module.
pub fn root_mean_square_error(simulated: &[f64], measured: &[f64]) -> Metric {
    let energies = Energies::of(simulated, measured)?;
    Ok((energies.difference / simulated.len() as f64).sqrt())
}

/// [`root_mean_square_error`] over the range of the measurement.
///
/// # Errors
/// The measurement is constant.
pub fn relative_to_range(simulated: &[f64], measured: &[f64]) -> Metric {
    let error = root_mean_square_error(simulated, measured)?;
    let (low, high) =
        measured.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| {
            (low.min(value), high.max(value))
        });
    if high > low { Ok(error / (high - low)) } else { undefined("the measured signal is constant") }
}

/// Root mean square of the simulation over that of the measurement; each may have samples of its
/// own.
///
/// # Errors
/// The measurement is zero throughout; a signal without samples, or with a sample that is not
/// finite.
pub fn rms_ratio(simulated: &[f64], measured: &[f64]) -> Metric {
    super::check_values(simulated, measured)?;
    let of = |signal: &[f64]| statistics::rms(signal).ok_or_else(too_large);
    let (of_simulated, of_measured) = (of(simulated)?, of(measured)?);
    if of_measured == 0.0 {
        return undefined("the measured signal is zero throughout");
    }
    Ok(of_simulated / of_measured)
}

/// Pearson's correlation, in [-1, 1].
///
/// # Errors
/// A signal is constant.
pub fn correlation(simulated: &[f64], measured: &[f64]) -> Metric {
    check(simulated, measured)?;
    statistics::correlation(simulated, measured)
        .ok_or_else(|| Undefined::because("one of the signals is constant"))
}

/// Misfit of Kraft et al.: `sum (s - m)^2 / min(sum s^2, sum m^2)`.
///
/// The formula is that of later papers; the original describes the smaller energy as the reference.
///
/// # Errors
/// A signal is zero throughout.
pub fn kraft_misfit(simulated: &[f64], measured: &[f64]) -> Metric {
    let energies = Energies::of(simulated, measured)?;
    let lower = energies.simulated.min(energies.measured);
    if lower == 0.0 {
        return undefined("one of the signals is zero throughout");
    }
    Ok(energies.difference / lower)
}

/// Weighted integrated factor: 1 for equal signals, 0 for signals of opposite sign throughout. It
/// is symmetric.
///
/// `1 - sqrt(sum max(m^2, s^2) (1 - max(0, m s) / max(m^2, s^2))^2 / sum max(m^2, s^2))`
///
/// # Errors
/// Both signals are zero throughout.
pub fn weighted_integrated_factor(simulated: &[f64], measured: &[f64]) -> Metric {
    check(simulated, measured)?;
    let larger = |s: f64, m: f64| (s * s).max(m * m);
    let whole = sum_of_pairs(simulated, measured, larger);
    if whole == 0.0 {
        return undefined("both signals are zero throughout");
    }
    let missing = sum_of_pairs(simulated, measured, |s, m| {
        let larger = larger(s, m);
        if larger == 0.0 { 0.0 } else { larger * (1.0 - (s * m).max(0.0) / larger).powi(2) }
    });
    let factor = 1.0 - (missing / whole).sqrt();
    if factor.is_finite() {
        Ok(factor)
    } else {
        undefined("the sum of the squares of the samples overflows")
    }
}

fn too_large() -> Undefined {
    Undefined::because("the samples exceed the range of numbers")
}
