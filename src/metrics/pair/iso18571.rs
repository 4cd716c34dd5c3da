//! Ratings of ISO/TS 18571:2014, each from 0 to 1 (best).
//!
//! As in the Python package `objective-rating-metrics` 1.3 (TU Graz), whose numbers the tests hold.
//! The standard asks for signals at 10 kHz; here the samples are those of the records.

use super::{
    Metric, Undefined, check,
    lag::{Agreement, best_shift, overlap},
    undefined, weighted,
};
use crate::metrics::{
    statistics::peak_magnitude,
    sum::{sum, sum_of, sum_of_pairs},
};

/// Half widths of the inner and outer corridor, as shares of the largest magnitude of the
/// measurement.
const INNER: f64 = 0.05;
const OUTER: f64 = 0.5;
/// The largest shift, as a share of the samples.
const LARGEST_SHIFT: f64 = 0.2;
/// Half width of the band in which the signals are warped onto each other, as a share of the
/// samples.
const WARPING: f64 = 0.1;
/// Relative errors of magnitude and of slope that are rated 0.
const WORST_MAGNITUDE: f64 = 0.5;
const WORST_SLOPE: f64 = 2.0;
/// Samples of the moving mean of the slopes, fewer at the ends: 1, 3, 5, 7.
const SMOOTHED: usize = 9;
/// Weights of corridor, phase, magnitude and slope.
const WEIGHTS: [f64; 4] = [0.4, 0.2, 0.2, 0.2];
/// Most cells of the warping band: a byte each, 400 MB. They are reached at 44,000 samples, 220 s
/// at 200 samples a second.
const MOST_CELLS: usize = 400_000_000;

/// Share of agreement with two corridors about the measurement: 1 inside the inner one, 0 outside
/// the outer one.
///
/// # Errors
/// The measurement is zero throughout; signals of different length, without samples, or with a
/// sample that is not finite.
pub fn iso18571_corridor(simulated: &[f64], measured: &[f64]) -> Metric {
    check(simulated, measured)?;
    let largest = peak_magnitude(measured).filter(|largest| *largest > 0.0);
    let largest =
        largest.ok_or_else(|| Undefined::because("the measured signal is zero throughout"))?;
    let (inner, outer) = (INNER * largest, OUTER * largest);
    let rating = |s: f64, m: f64| match (s - m).abs() {
        apart if apart < inner => 1.0,
        apart if apart > outer => 0.0,
        apart => ((outer - apart) / (outer - inner)).powi(2),
    };
    Ok(sum_of_pairs(simulated, measured, rating) / simulated.len() as f64)
}

/// Rating of the shift with the best correlation: 1 at none, 0 at a fifth of the samples.
///
/// # Errors
/// A signal is constant; and as [`iso18571_corridor`].
pub fn iso18571_phase(simulated: &[f64], measured: &[f64]) -> Metric {
    Ok(phase_of(shift(simulated, measured)?, simulated.len()))
}

/// Rating of the amplitudes after the shift and after dynamic time warping.
///
/// # Errors
/// As [`iso18571_phase`]; more samples than can be warped.
pub fn iso18571_magnitude(simulated: &[f64], measured: &[f64]) -> Metric {
    magnitude_at(simulated, measured, shift(simulated, measured)?)
}

/// Rating of the slopes after the shift.
///
/// # Errors
/// As [`iso18571_phase`]; fewer than nine samples after the shift.
pub fn iso18571_slope(simulated: &[f64], measured: &[f64]) -> Metric {
    slope_at(simulated, measured, shift(simulated, measured)?)
}

/// The four ratings together, the corridor counting twice.
///
/// # Errors
/// As these.
pub fn iso18571_overall(simulated: &[f64], measured: &[f64]) -> Metric {
    let corridor = iso18571_corridor(simulated, measured)?;
    let shift = shift(simulated, measured)?;
    let phase = phase_of(shift, simulated.len());
    let ratings = [
        corridor,
        phase,
        magnitude_at(simulated, measured, shift)?,
        slope_at(simulated, measured, shift)?,
    ];
    Ok(weighted(ratings, WEIGHTS))
}

fn shift(simulated: &[f64], measured: &[f64]) -> Result<isize, Undefined> {
    check(simulated, measured)?;
    best_shift(
        simulated,
        measured,
        (LARGEST_SHIFT * simulated.len() as f64).floor() as usize,
        Agreement::Correlation,
    )
}

fn phase_of(shift: isize, count: usize) -> f64 {
    let largest = LARGEST_SHIFT * count as f64;
    ((largest - shift.unsigned_abs() as f64) / largest).max(0.0)
}

fn magnitude_at(simulated: &[f64], measured: &[f64], shift: isize) -> Metric {
    let (s, m) = overlap(simulated, measured, shift);
    let path = warp(s, m)?;
    let apart: Vec<f64> = path.iter().map(|&(i, j)| (s[i] - m[j]).abs()).collect();
    let whole: Vec<f64> = path.iter().map(|&(_, j)| m[j].abs()).collect();
    rated(sum(&apart), sum(&whole), WORST_MAGNITUDE)
}

fn slope_at(simulated: &[f64], measured: &[f64], shift: isize) -> Metric {
    let (s, m) = overlap(simulated, measured, shift);
    if s.len() < SMOOTHED {
        return undefined(format!(
            "{} samples overlap after the shift, and the slopes need {SMOOTHED}",
            s.len()
        ));
    }
    let (s, m) = (smoothed_slopes(s), smoothed_slopes(m));
    rated(sum_of_pairs(&s, &m, |s, m| (s - m).abs()), sum_of(&m, f64::abs), WORST_SLOPE)
}

/// 1 without an error, 0 from the worst relative error on.
fn rated(error: f64, whole: f64, worst: f64) -> Metric {
    if whole == 0.0 {
        return undefined("the measured signal is constant");
    }
    Ok(((worst - error / whole) / worst).max(0.0))
}

/// Central differences for each step of the samples, one-sided at the ends, and their moving mean.
fn smoothed_slopes(signal: &[f64]) -> Vec<f64> {
    let last = signal.len() - 1;
    let slopes: Vec<f64> = (0..=last)
        .map(|at| match at {
            0 => signal[1] - signal[0],
            at if at == last => signal[last] - signal[last - 1],
            at => (signal[at + 1] - signal[at - 1]) / 2.0,
        })
        .collect();
    let half = |at: usize| at.min(last - at).min(SMOOTHED / 2);
    (0..=last)
        .map(|at| {
            slopes[at - half(at)..=at + half(at)].iter().sum::<f64>() / (2 * half(at) + 1) as f64
        })
        .collect()
}

/// The cheapest way through both signals, as pairs of samples, last pair first: squared distances,
/// steps of one sample of either signal or of both, no more than the width of the band apart.
///
/// Pairs are numbered by the simulated sample `i` on the diagonal `d = i + j`. A pair depends only
/// on the two diagonals before its own, so that a processor can do several pairs of a diagonal at
/// once.
fn warp(simulated: &[f64], measured: &[f64]) -> Result<Vec<(usize, usize)>, Undefined> {
    let count = simulated.len();
    let band = ((WARPING * count as f64).ceil() as usize).saturating_sub(1);
    let width = band + 1;
    if count.saturating_mul(2 * width) > MOST_CELLS {
        return undefined(format!(
            "{count} samples are too many to be warped onto each other; resample the signals"
        ));
    }
    let last = count - 1;
    let range = |d: usize| {
        d.saturating_sub(last).max(d.saturating_sub(band).div_ceil(2))
            ..=last.min(d).min((d + band) / 2)
    };
    let backwards: Vec<f64> = measured.iter().rev().copied().collect();
    let mut steps = vec![SIMULATED; (2 * last + 1) * width];
    // Costs of a diagonal, of the one before it and of the one before that; the pair of sample `i`
    // stands at `i + 1`.
    let [mut row, mut before, mut earlier] = [(); 3].map(|()| vec![f64::INFINITY; count + 2]);
    before[1] = (simulated[0] - measured[0]).powi(2);
    for d in 1..=2 * last {
        let (first, end) = range(d).into_inner();
        let backwards = &backwards[last + first - d..];
        // With a band of no width every second diagonal is empty.
        let steps = &mut steps[d * width..][..end + 1 - first];
        let pairs = simulated[first..]
            .iter()
            .zip(backwards)
            .zip(&before[first..])
            .zip(&before[first + 1..])
            .zip(&earlier[first..]);
        for ((cost, step), ((((s, m), along), across), both)) in
            row[first + 1..].iter_mut().zip(steps).zip(pairs)
        {
            // Of equal ways the one written first.
            let (cheaper, first_step) =
                if across < along { (across, MEASURED) } else { (along, SIMULATED) };
            let (cheapest, chosen) =
                if both < cheaper { (both, BOTH) } else { (cheaper, first_step) };
            *cost = cheapest + (s - m) * (s - m);
            *step = chosen;
        }
        // The pairs beside the diagonal bar the way; older costs stand there.
        (row[first], row[end + 2]) = (f64::INFINITY, f64::INFINITY);
        std::mem::swap(&mut earlier, &mut before);
        std::mem::swap(&mut before, &mut row);
    }
    let (mut i, mut j) = (last, last);
    let mut path = vec![(i, j)];
    while (i, j) != (0, 0) {
        match steps[(i + j) * width + i - range(i + j).start()] {
            SIMULATED => i -= 1,
            MEASURED => j -= 1,
            _ => (i, j) = (i - 1, j - 1),
        }
        path.push((i, j));
    }
    Ok(path)
}

/// Which signal goes one sample on.
const SIMULATED: u8 = 0;
const MEASURED: u8 = 1;
const BOTH: u8 = 2;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_follows_a_delay_within_the_band() {
        let measured: Vec<f64> = (0..100).map(|k| f64::from(k).min(50.0)).collect();
        let simulated: Vec<f64> = (0..100).map(|k| (f64::from(k) - 4.0).clamp(0.0, 50.0)).collect();
        let path = warp(&simulated, &measured).expect("few samples");
        let apart: f64 = path.iter().map(|&(i, j)| (simulated[i] - measured[j]).abs()).sum();
        assert!(apart == 0.0, "{apart}");
        assert!(path.iter().all(|&(i, j)| i.abs_diff(j) <= 9));
        assert_eq!((path.first(), path.last()), (Some(&(99, 99)), Some(&(0, 0))));
    }

    #[test]
    fn too_many_samples_are_refused() {
        let long = vec![1.0; 50_000];
        assert!(warp(&long, &long).expect_err("too many").reason.contains("resample"));
    }

    #[test]
    fn ends_are_averaged_over_fewer_samples() {
        let ramp: Vec<f64> = (0..20).map(|k| 3.0 * f64::from(k)).collect();
        assert!(smoothed_slopes(&ramp).iter().all(|slope| (slope - 3.0).abs() < 1e-12));
    }
}
