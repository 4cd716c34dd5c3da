//! Ratings in the manner of CORA (correlation and analysis), each from 0 to 1 (best). Unverified.
//!
//! After the description by Gehre, Gades and Wernicke, "Objective rating of signals using test and
//! simulation responses", ESV 2009, and that of Altair HyperGraph. The program CORA was not to
//! hand: no number here is checked against it.

use super::{
    Energies, Metric, Undefined, check, iso18571_corridor,
    lag::{Agreement, best_shift, overlap},
    undefined, weighted,
};
use crate::metrics::sum::sum_of_pairs;

/// The largest shift, as a share of the samples: the signals overlap by 80 % at least.
const LARGEST_SHIFT: f64 = 0.2;
/// Exponent of the progression rating.
const PROGRESSION: i32 = 10;
/// Shifts rated 1 and 0, as shares of the interval.
const NO_SHIFT: f64 = 0.01;
const WORST_SHIFT: f64 = 0.12;
/// Weights of progression, size and phase in the rating by cross-correlation; this and that of the
/// corridor count alike.
const WEIGHTS: [f64; 3] = [0.5, 0.25, 0.25];

/// Rating by the corridors, with the widths of ISO/TS 18571.
///
/// # Errors
/// As [`iso18571_corridor`].
pub fn cora_corridor(simulated: &[f64], measured: &[f64]) -> Metric {
    iso18571_corridor(simulated, measured)
}

/// Rating of the shape: the cosine of the angle between the signals at the best shift.
///
/// # Errors
/// A signal is zero throughout; and as [`iso18571_corridor`].
pub fn cora_progression(simulated: &[f64], measured: &[f64]) -> Metric {
    Ok(Ratings::of(simulated, measured)?.progression)
}

/// Rating of the size: the smaller over the larger sum of squares at the best shift.
///
/// # Errors
/// As [`cora_progression`].
pub fn cora_size(simulated: &[f64], measured: &[f64]) -> Metric {
    Ok(Ratings::of(simulated, measured)?.size)
}

/// Rating of the best shift.
///
/// # Errors
/// As [`cora_progression`].
pub fn cora_phase(simulated: &[f64], measured: &[f64]) -> Metric {
    Ok(Ratings::of(simulated, measured)?.phase)
}

/// The mean of the rating by the corridors and that by cross-correlation.
///
/// # Errors
/// As [`cora_progression`].
pub fn cora_total(simulated: &[f64], measured: &[f64]) -> Metric {
    let Ratings { progression, size, phase } = Ratings::of(simulated, measured)?;
    let by_correlation = weighted([progression, size, phase], WEIGHTS);
    Ok((cora_corridor(simulated, measured)? + by_correlation) / 2.0)
}

/// Ratings by cross-correlation.
struct Ratings {
    progression: f64,
    size: f64,
    phase: f64,
}

impl Ratings {
    fn of(simulated: &[f64], measured: &[f64]) -> Result<Self, Undefined> {
        check(simulated, measured)?;
        if simulated.len() < 2 {
            return undefined("one sample has no interval");
        }
        let most = (LARGEST_SHIFT * simulated.len() as f64).floor() as usize;
        let shift = best_shift(simulated, measured, most, Agreement::Cosine)
            .map_err(|_| Undefined::because("one of the signals is zero throughout"))?;
        let (s, m) = overlap(simulated, measured, shift);
        let energies = Energies::of(s, m)?;
        let cosine =
            sum_of_pairs(s, m, |s, m| s * m) / (energies.simulated * energies.measured).sqrt();
        let share = shift.unsigned_abs() as f64 / (simulated.len() - 1) as f64;
        Ok(Self {
            progression: ((cosine.clamp(-1.0, 1.0) + 1.0) / 2.0).powi(PROGRESSION),
            size: energies.simulated.min(energies.measured)
                / energies.simulated.max(energies.measured),
            phase: ((WORST_SHIFT - share) / (WORST_SHIFT - NO_SHIFT)).clamp(0.0, 1.0),
        })
    }
}
