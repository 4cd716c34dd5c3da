//! Measures of agreement of a simulated and a measured signal with equal length and common points.
//! The measurement is the reference.
//!
//! Every metric is `fn(simulated, measured) -> Metric`. The mean is not removed.
//! Sums replace integrals over a uniform grid, as the sampling distance cancels.

mod alignment;
mod cora;
mod deviation;
mod distribution;
mod geers;
mod iso18571;
pub mod lag;
mod theil;

pub use alignment::{drift, mirrored_correlation, shift};
pub use cora::{cora_corridor, cora_phase, cora_progression, cora_size, cora_total};
pub use deviation::{
    correlation, kraft_misfit, relative_to_range, rms_ratio, root_mean_square_error,
    weighted_integrated_factor,
};
pub use distribution::{
    area_between, area_metric, bogojevic, bogojevic_mean_term, bogojevic_variance_probability,
    bogojevic_variance_ratio, f_two_sided, quantiles_of_sorted,
};
pub use geers::{
    russell_comprehensive, russell_magnitude, russell_phase, sprague_geers_comprehensive,
    sprague_geers_magnitude, sprague_geers_phase,
};
pub use iso18571::{
    iso18571_corridor, iso18571_magnitude, iso18571_overall, iso18571_phase, iso18571_slope,
};
pub use theil::{theil_bias, theil_covariance, theil_u1, theil_u2, theil_variance};

use std::fmt;

use super::sum::{sum_of, sum_of_pairs};

/// Reason why a metric has no value for these signals.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Undefined {
    pub reason: String,
}

impl Undefined {
    pub(super) fn because(reason: impl Into<String>) -> Self {
        Self { reason: reason.into() }
    }
}

impl fmt::Display for Undefined {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.reason)
    }
}

/// A number, or the reason why there is none.
pub type Metric = Result<f64, Undefined>;

pub(super) fn undefined<T>(reason: impl Into<String>) -> Result<T, Undefined> {
    Err(Undefined::because(reason))
}

/// Checks for equal length, at least one sample, and finite samples.
fn check(simulated: &[f64], measured: &[f64]) -> Result<(), Undefined> {
    if simulated.len() != measured.len() {
        return undefined(format!(
            "the simulated signal has {} samples, the measured {}",
            simulated.len(),
            measured.len()
        ));
    }
    if simulated.is_empty() {
        return undefined("the signals have no samples");
    }
    check_finite(simulated, "simulated")?;
    check_finite(measured, "measured")
}

/// Values on both sides, not equally many.
fn check_values(simulated: &[f64], measured: &[f64]) -> Result<(), Undefined> {
    for (signal, which) in [(simulated, "simulated"), (measured, "measured")] {
        if signal.is_empty() {
            return undefined(format!("the {which} signal has no samples"));
        }
        check_finite(signal, which)?;
    }
    Ok(())
}

fn check_finite(signal: &[f64], which: &str) -> Result<(), Undefined> {
    match signal.iter().position(|value| !value.is_finite()) {
        Some(at) => undefined(format!("sample {} of the {which} signal is not finite", at + 1)),
        None => Ok(()),
    }
}

/// The sum of some ratings, each with its weight.
fn weighted<const N: usize>(ratings: [f64; N], weights: [f64; N]) -> f64 {
    ratings.iter().zip(weights).map(|(rating, weight)| rating * weight).sum()
}

/// Sums of squares of the simulation, the measurement and their difference.
#[derive(Clone, Copy)]
struct Energies {
    simulated: f64,
    measured: f64,
    difference: f64,
}

impl Energies {
    fn of(simulated: &[f64], measured: &[f64]) -> Result<Self, Undefined> {
        check(simulated, measured)?;
        let energies = Self {
            simulated: sum_of(simulated, |value| value * value),
            measured: sum_of(measured, |value| value * value),
            difference: sum_of_pairs(simulated, measured, |s, m| (s - m) * (s - m)),
        };
        let Self { simulated, measured, difference } = energies;
        if [simulated, measured, difference].iter().all(|sum| sum.is_finite()) {
            Ok(energies)
        } else {
            undefined("the sum of the squares of the samples overflows")
        }
    }
}
