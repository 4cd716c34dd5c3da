//! Band-limited interpolation: a signal with constant steps at other points, by a windowed sinc. It
//! filters and interpolates in one step: content above the wanted band does not fold into it.

use std::f64::consts::PI;

/// Frequency of the filter at -6 dB as a share of the lower of both sampling rates. With
/// `CROSSINGS` and `BETA` the band below 0.41 of that rate is unchanged (to 1e-4), and what is
/// above 0.49 of it is suppressed to 1e-4.
pub const CUTOFF: f64 = 0.45;
/// Zero crossings of the sinc on each side.
const CROSSINGS: f64 = 32.0;
/// Parameter of the Kaiser window: side lobes of about -80 dB.
const BETA: f64 = 8.0;

/// The signal at fractional sample numbers, filtered for a new sampling rate that is `ratio` of the
/// old one. Beyond its ends the signal is continued by odd reflection.
///
/// `None` for a signal of fewer than two samples, a ratio that is not positive, or points outside
/// the signal.
pub fn interpolate(signal: &[f64], points: &[f64], ratio: f64) -> Option<Vec<f64>> {
    let last = signal.len().checked_sub(1).filter(|last| *last > 0)?;
    if ratio.is_nan()
        || ratio <= 0.0
        || points.iter().any(|point| !(-1e-6..=last as f64 + 1e-6).contains(point))
    {
        return None;
    }
    let cutoff = CUTOFF * ratio.min(1.0);
    let half = CROSSINGS / (2.0 * cutoff);
    let scale = bessel(BETA);
    let sample = |at: i64| {
        // Odd reflection; twice for a signal shorter than the kernel, then its end value.
        let last = last as i64;
        let (mut at, mut sign, mut add) = (at, 1.0, 0.0);
        for _ in 0..2 {
            let end = if at < 0 {
                0
            } else if at > last {
                last
            } else {
                break;
            };
            add += sign * 2.0 * signal[end as usize];
            sign = -sign;
            at = 2 * end - at;
        }
        add + sign * signal[at.clamp(0, last) as usize]
    };
    let one = |point: &f64| {
        let (mut sum, mut weights) = (0.0, 0.0);
        for at in (point - half).ceil() as i64..=(point + half).floor() as i64 {
            let x = at as f64 - point;
            let window = bessel(BETA * (1.0 - (x / half).powi(2)).max(0.0).sqrt()) / scale;
            let weight = sinc(2.0 * cutoff * x) * window;
            sum += weight * sample(at);
            weights += weight;
        }
        sum / weights
    };
    Some(points.iter().map(one).collect())
}

fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) }
}

/// Modified Bessel function of the first kind, order zero, by its series.
fn bessel(x: f64) -> f64 {
    let (mut sum, mut term, mut k) = (1.0, 1.0, 1.0);
    while term > 1e-17 * sum {
        term *= (x / (2.0 * k)).powi(2);
        sum += term;
        k += 1.0;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tone(frequency: f64, rate: f64, samples: usize) -> Vec<f64> {
        (0..samples).map(|at| (2.0 * PI * frequency * at as f64 / rate).sin()).collect()
    }

    fn to(signal: &[f64], from: f64, to: f64) -> Vec<f64> {
        let samples = ((signal.len() - 1) as f64 * to / from).floor() as usize + 1;
        let points: Vec<f64> = (0..samples).map(|at| at as f64 * from / to).collect();
        interpolate(signal, &points, to / from).expect("points inside")
    }

    /// The tone at the new rate, away from the ends.
    #[test]
    fn the_band_is_unchanged() {
        for (from, rate, frequency) in
            [(600.0, 200.0, 20.0), (600.0, 200.0, 80.0), (333.0, 200.0, 60.0), (200.0, 500.0, 75.0)]
        {
            let found = to(&tone(frequency, from, 3000), from, rate);
            let wanted = tone(frequency, rate, found.len());
            let middle = found.len() / 4..3 * found.len() / 4;
            let worst = middle.map(|at| (found[at] - wanted[at]).abs()).fold(0.0, f64::max);
            assert!(worst < 2e-4, "{from} to {rate} Hz, {frequency} Hz: {worst}");
        }
    }

    /// 120 Hz would fold to 80 Hz at 200 Hz.
    #[test]
    fn what_is_above_does_not_fold() {
        for frequency in [99.0, 120.0, 180.0, 290.0] {
            let found = to(&tone(frequency, 600.0, 3000), 600.0, 200.0);
            let worst = found[found.len() / 4..3 * found.len() / 4]
                .iter()
                .fold(0.0_f64, |most, value| most.max(value.abs()));
            assert!(worst < 2e-4, "{frequency} Hz: {worst}");
        }
    }

    /// A line is kept to its ends by the odd reflection.
    #[test]
    fn a_line_is_kept_to_its_ends() {
        let line: Vec<f64> = (0..200).map(|at| 3.0 + 0.5 * f64::from(at)).collect();
        let points: Vec<f64> = (0..=398).map(|at| 0.5 * f64::from(at)).collect();
        for (point, value) in
            points.iter().zip(interpolate(&line, &points, 1.0).expect("points inside"))
        {
            assert!((value - (3.0 + 0.5 * point)).abs() < 2e-3, "{point}: {value}");
        }
        assert!(
            interpolate(&line, &[200.0], 1.0).is_none()
                && interpolate(&line, &[1.0], 0.0).is_none()
        );
        assert!(interpolate(&[1.0], &[0.0], 1.0).is_none());
        assert!(
            interpolate(&line[..5], &points[..8], 0.3)
                .expect("a short signal")
                .iter()
                .all(|value| value.is_finite())
        );
    }
}
