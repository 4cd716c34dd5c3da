//! Metrics of the values of the signals regardless of their order.

use super::{Metric, Undefined, check, check_values, undefined};
use crate::metrics::{
    incomplete_beta::incomplete_beta,
    percentile::{Method, percentiles_of_sorted},
    statistics::{Divisor, mean, peak_magnitude, variance},
    sum::{sum, sum_of_pairs},
};

/// A mean below this share of the signal's largest magnitude is rounding.
const ZERO_MEAN: f64 = 1e-12;

/// Area between the distribution functions of the values (Ferson, Oberkampf and Ginzburg 2008), in
/// the unit of the signals.
///
/// For equal numbers of values, this is the mean distance of the sorted values (1-Wasserstein
/// distance).
///
/// # Errors
/// Signals of different length, without samples, or with a sample that is not finite.
pub fn area_metric(simulated: &[f64], measured: &[f64]) -> Metric {
    check(simulated, measured)?;
    let area = sum_of_pairs(&sorted(simulated), &sorted(measured), |s, m| (s - m).abs())
        / simulated.len() as f64;
    in_range(area)
}

/// The distribution of a signal, whose samples are sorted, as `points` values: the quantiles at
/// (i - 0.5)/n, i = 1 to n, with linear interpolation between order statistics (type 7). There may
/// be more points than samples.
///
/// # Errors
/// No points, no samples, a sample that is not finite.
pub fn quantiles_of_sorted(sorted: &[f64], points: usize) -> Result<Vec<f64>, Undefined> {
    if points == 0 {
        return undefined("a distribution needs at least one point");
    }
    let percents: Vec<f64> =
        (0..points).map(|point| 100.0 * (point as f64 + 0.5) / points as f64).collect();
    percentiles_of_sorted(sorted, &percents, Method::Linear)
        .map_err(|error| Undefined::because(error.to_string()))
}

/// [`area_metric`] for different numbers of values: the integral of the distance between the
/// distribution functions.
///
/// # Errors
/// No values on either side, or a value that is not finite.
pub fn area_between(simulated: &[f64], measured: &[f64]) -> Metric {
    check_values(simulated, measured)?;
    let (simulated, measured) = (sorted(simulated), sorted(measured));
    let (mut below_s, mut below_m) = (0, 0);
    let mut strips = Vec::with_capacity(simulated.len() + measured.len());
    let mut from = simulated[0].min(measured[0]);
    while below_s < simulated.len() || below_m < measured.len() {
        let next =
            |values: &[f64], below: usize| values.get(below).copied().unwrap_or(f64::INFINITY);
        let to = next(&simulated, below_s).min(next(&measured, below_m));
        let height =
            below_s as f64 / simulated.len() as f64 - below_m as f64 / measured.len() as f64;
        strips.push(height.abs() * (to - from));
        below_s += usize::from(next(&simulated, below_s) == to);
        below_m += usize::from(next(&measured, below_m) == to);
        from = to;
    }
    in_range(sum(&strips))
}

/// Ratio of the variances (n - 1), simulation divided by measurement.
///
/// # Errors
/// The measurement is constant, or there is one sample only.
pub fn bogojevic_variance_ratio(simulated: &[f64], measured: &[f64]) -> Metric {
    check_values(simulated, measured)?;
    let of = |signal: &[f64]| {
        variance(signal, Divisor::Sample)
            .ok_or_else(|| Undefined::because("the scatter of a single sample is not defined"))
    };
    let (of_simulated, of_measured) = (of(simulated)?, of(measured)?);
    if of_measured == 0.0 {
        return undefined("the measured signal is constant");
    }
    Ok(of_simulated / of_measured)
}

/// Two-sided probability of this ratio, or one farther from 1, for equal variances and independent
/// samples (F test). The degrees of freedom are the numbers of samples minus one.
///
/// Consecutive samples of a record are not independent: with their full number, the probability is
/// far too small. Use values that are far enough apart to be independent.
///
/// # Errors
/// As [`bogojevic_variance_ratio`].
pub fn bogojevic_variance_probability(simulated: &[f64], measured: &[f64]) -> Metric {
    let degrees = |signal: &[f64]| signal.len() as f64 - 1.0;
    Ok(f_two_sided(
        bogojevic_variance_ratio(simulated, measured)?,
        degrees(simulated),
        degrees(measured),
    ))
}

/// Agreement of the means: `1 - |mean s - mean m| / max(|mean s|, |mean m|)`, down to -1 for means
/// of opposite sign; 1 where both are zero.
///
/// # Errors
/// A signal without samples, or with a sample that is not finite.
pub fn bogojevic_mean_term(simulated: &[f64], measured: &[f64]) -> Metric {
    check_values(simulated, measured)?;
    let too_large = || Undefined::because("the sum of the samples overflows");
    let (Some(of_simulated), Some(of_measured)) = (mean(simulated), mean(measured)) else {
        return Err(too_large());
    };
    let larger = of_simulated.abs().max(of_measured.abs());
    let magnitude = peak_magnitude(simulated)
        .zip(peak_magnitude(measured))
        .map(|(s, m)| s.max(m))
        .ok_or_else(too_large)?;
    if larger <= ZERO_MEAN * magnitude {
        return Ok(1.0);
    }
    Ok(1.0 - (of_simulated - of_measured).abs() / larger)
}

/// Metric of Bogojevic and Lucanin: probability of the variance ratio times the agreement of the
/// means, of which a negative one counts 0; 1 is best.
///
/// # Errors
/// As [`bogojevic_variance_ratio`].
pub fn bogojevic(simulated: &[f64], measured: &[f64]) -> Metric {
    Ok(bogojevic_variance_probability(simulated, measured)?
        * bogojevic_mean_term(simulated, measured)?.max(0.0))
}

/// Two-sided probability of a variance ratio under the F distribution: twice the smaller tail, at
/// most 1.
///
/// Each tail is computed from the incomplete beta function; one minus the other tail would lose
/// digits.
pub fn f_two_sided(ratio: f64, numerator_degrees: f64, denominator_degrees: f64) -> f64 {
    let whole = numerator_degrees * ratio + denominator_degrees;
    let (of_numerator, of_denominator) =
        (numerator_degrees * ratio / whole, denominator_degrees / whole);
    let (a, b) = (numerator_degrees / 2.0, denominator_degrees / 2.0);
    let lower = incomplete_beta(a, b, of_numerator, of_denominator);
    let upper = incomplete_beta(b, a, of_denominator, of_numerator);
    (2.0 * lower.min(upper)).min(1.0)
}

fn in_range(area: f64) -> Metric {
    if area.is_finite() { Ok(area) } else { undefined("the sum of the differences overflows") }
}

fn sorted(values: &[f64]) -> Vec<f64> {
    let mut values = values.to_vec();
    values.sort_unstable_by(f64::total_cmp);
    values
}
