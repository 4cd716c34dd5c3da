//! Magnitude, phase and comprehensive errors: Sprague and Geers, Russell.
//!
//! Sources: Geers, "An objective error measure for the comparison of calculated and measured
//! transient response histories", Shock and Vibration Bulletin 54 (1984); Sprague and Geers, "A
//! spectral-element method for modelling cavitation in transient fluid-structure interaction", Int.
//! J. Numer. Meth. Eng. 60 (2004); Russell, "Error measures for comparing transient data", Proc.
//! 68th Shock and Vibration Symposium (1997).

use std::f64::consts::PI;

use super::{Energies, Metric, Undefined, undefined};
use crate::metrics::sum::sum_of_pairs;

/// Sprague and Geers magnitude error: `sqrt(sum s^2 / sum m^2) - 1`. Negative if the simulation is
/// smaller.
///
/// # Errors
/// The measurement is zero throughout.
pub fn sprague_geers_magnitude(simulated: &[f64], measured: &[f64]) -> Metric {
    magnitude(&Energies::of(simulated, measured)?)
}

/// Sprague and Geers phase error: the angle between the signals divided by pi, `acos(sum s m /
/// sqrt(sum s^2 sum m^2)) / pi`, in [0, 1].
///
/// # Errors
/// A signal is zero throughout.
pub fn sprague_geers_phase(simulated: &[f64], measured: &[f64]) -> Metric {
    Ok(angle(simulated, measured, &Energies::of(simulated, measured)?)? / PI)
}

/// Sprague and Geers comprehensive error: `sqrt(magnitude^2 + phase^2)`.
///
/// # Errors
/// A signal is zero throughout.
pub fn sprague_geers_comprehensive(simulated: &[f64], measured: &[f64]) -> Metric {
    let energies = Energies::of(simulated, measured)?;
    Ok(magnitude(&energies)?.hypot(angle(simulated, measured, &energies)? / PI))
}

/// Russell's magnitude error: `sign(r) log10(1 + |r|)`, `r = (S - M) / sqrt(S M)`, with S and M the
/// sums of squares.
///
/// # Errors
/// A signal is zero throughout.
pub fn russell_magnitude(simulated: &[f64], measured: &[f64]) -> Metric {
    russell(&Energies::of(simulated, measured)?)
}

/// Russell's phase error, the same as that of Sprague and Geers.
///
/// # Errors
/// A signal is zero throughout.
pub fn russell_phase(simulated: &[f64], measured: &[f64]) -> Metric {
    sprague_geers_phase(simulated, measured)
}

/// Russell's comprehensive error: `sqrt(pi/4 (magnitude^2 + phase^2))`.
///
/// # Errors
/// A signal is zero throughout.
pub fn russell_comprehensive(simulated: &[f64], measured: &[f64]) -> Metric {
    let energies = Energies::of(simulated, measured)?;
    let phase = angle(simulated, measured, &energies)? / PI;
    Ok((PI / 4.0).sqrt() * russell(&energies)?.hypot(phase))
}

fn magnitude(energies: &Energies) -> Metric {
    if energies.measured == 0.0 {
        return undefined("the measured signal is zero throughout");
    }
    Ok(energies.simulated.sqrt() / energies.measured.sqrt() - 1.0)
}

fn russell(energies: &Energies) -> Metric {
    both_move(energies)?;
    // (S - M) / sqrt(S M), without overflow of the product or the difference of the energies.
    let ratio = energies.simulated.sqrt() / energies.measured.sqrt();
    let relative = ratio - 1.0 / ratio;
    Ok(relative.signum() * relative.abs().ln_1p() / std::f64::consts::LN_10)
}

/// Angle between the signals, in [0, pi].
///
/// The cosine of a small angle has half the digits only, and rounding can make it larger than 1.
/// Kahan's formula, from the sides of the triangle of the two unit signals, has neither problem.
fn angle(simulated: &[f64], measured: &[f64], energies: &Energies) -> Metric {
    both_move(energies)?;
    let (s_length, m_length) = (energies.simulated.sqrt(), energies.measured.sqrt());
    let side = |sign: f64| {
        let component = |s: f64, m: f64| s / s_length + sign * m / m_length;
        sum_of_pairs(simulated, measured, |s, m| component(s, m) * component(s, m)).sqrt()
    };
    Ok(2.0 * side(-1.0).atan2(side(1.0)))
}

fn both_move(energies: &Energies) -> Result<(), Undefined> {
    if energies.measured == 0.0 {
        undefined("the measured signal is zero throughout")
    } else if energies.simulated == 0.0 {
        undefined("the simulated signal is zero throughout")
    } else {
        Ok(())
    }
}
