//! Comparison sample by sample: the difference of the two records of a channel, regressed on the
//! changes that the effects cause.
//!
//! The change of a simulated channel with each candidate effect is a function of time. The
//! difference of the records is projected on an orthonormal basis of these changes, section by
//! section; both are prewhitened by an autoregressive filter of what the changes leave, so that the
//! coordinates have independent errors of one variance. The features of a section are these
//! coordinates.
//!
//! Prewhitening gives every frequency the weight of its noise, so that it would rely on frequencies
//! where there is least noise and the simulation does not hold. The records are therefore compared
//! up to the highest band of the channel only.

use nalgebra::{DMatrix, DVector};

use crate::data::hash::sha256;
use crate::diagnose::levels::increments::{LIMIT_ORDER, NEW, ORDER, SAMPLES};
use crate::metrics::filter::{Band, Cutoff, Filter, Phase};

/// Samples of the frequencies below a limit.
#[derive(Clone, Debug)]
pub struct Limit {
    filter: Filter,
    every: usize,
}

impl Limit {
    /// For samples at a rate in Hz, up to a frequency in Hz. Nothing where they have hardly any
    /// higher frequencies.
    pub fn new(rate: f64, frequency: f64) -> Option<Self> {
        let every = (rate / (2.0 * frequency)).floor();
        if !every.is_finite() || every < 2.0 {
            return None;
        }
        let filter = Filter::design(
            Band::LowPass(frequency),
            LIMIT_ORDER,
            rate,
            Phase::Zero,
            Cutoff::PerPass,
        )
        .ok()?;
        Some(Self { filter, every: every as usize })
    }

    fn apply(&self, series: &[f64]) -> Option<Vec<f64>> {
        Some(self.filter.apply(series).ok()?.into_iter().step_by(self.every).collect())
    }
}

/// As many samples as are needed for the frequencies compared; nothing where there are too few.
fn limited(limit: Option<&Limit>, series: &[f64]) -> Option<Vec<f64>> {
    limit.map_or_else(|| Some(series.to_vec()), |limit| limit.apply(series))
}

/// The basis of one channel in one section.
#[derive(Clone, Debug)]
pub struct Increments {
    limit: Option<Limit>,
    /// Number of samples of the record.
    samples: usize,
    /// Coefficients of the autoregressive filter.
    filter: Vec<f64>,
    /// The simulated record, limited.
    reference: Vec<f64>,
    /// Orthonormal, prewhitened; as many as there are changes, zero where a change adds no
    /// direction.
    basis: Vec<Vec<f64>>,
    /// Variance of each coordinate, in the square of the channel's unit.
    pub variance: f64,
    /// Coordinates of the simulated record, for a gain, and of one unit, for an offset.
    pub signal: Vec<f64>,
    pub one: Vec<f64>,
}

impl Increments {
    /// From the changes of a channel with the effects, and both records of it. Nothing where the
    /// section is too short.
    pub fn new(
        changes: &[Vec<f64>],
        simulated: &[f64],
        measured: &[f64],
        limit: Option<Limit>,
    ) -> Option<Self> {
        let samples = simulated.len();
        if measured.len() != samples || changes.iter().any(|change| change.len() != samples) {
            return None;
        }
        let (simulated, measured) =
            (limited(limit.as_ref(), simulated)?, limited(limit.as_ref(), measured)?);
        let changes: Vec<Vec<f64>> =
            changes.iter().map(|change| limited(limit.as_ref(), change)).collect::<Option<_>>()?;
        let n = simulated.len();
        let difference: Vec<f64> = measured.iter().zip(&simulated).map(|(a, b)| a - b).collect();
        let directions = orthonormal(&changes);
        let own = directions.iter().filter(|direction| direction.iter().any(|x| *x != 0.0)).count();
        // A short section has no samples for a long filter.
        let order = ORDER.min((n / SAMPLES).checked_sub(own + 1)?);
        let filter = autoregression(&across(&directions, &difference), order);
        let changes: Vec<Vec<f64>> =
            changes.iter().map(|change| prewhitened(&filter, change)).collect();
        let basis = orthonormal(&changes);
        let left = across(&basis, &prewhitened(&filter, &difference));
        let freedom = left.len()
            - basis.iter().filter(|direction| direction.iter().any(|x| *x != 0.0)).count()
            - filter.len();
        let variance = left.iter().map(|x| x * x).sum::<f64>() / freedom.max(1) as f64;
        let mut made = Self {
            limit,
            samples,
            filter,
            reference: vec![0.0; n],
            basis,
            variance,
            signal: Vec::new(),
            one: Vec::new(),
        };
        (made.signal, made.one) = (made.along(&simulated), made.along(&vec![1.0; n]));
        made.reference = simulated;
        Some(made)
    }

    /// A hash of the basis and of the record it refers to.
    pub fn identity(&self) -> String {
        let numbers = self.basis.iter().flatten().chain(&self.filter).chain(&self.reference);
        sha256(&numbers.flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>())
    }

    /// The coordinates of a record of the channel relative to the simulated record; nothing for
    /// another number of samples.
    pub fn of(&self, values: &[f64]) -> Option<Vec<f64>> {
        if values.len() != self.samples {
            return None;
        }
        Some(self.along(&limited(self.limit.as_ref(), values)?))
    }

    /// As [`Self::of`], of a limited record.
    fn along(&self, values: &[f64]) -> Vec<f64> {
        let difference: Vec<f64> = values
            .iter()
            .zip(&self.reference)
            .map(|(value, reference)| value - reference)
            .collect();
        let white = prewhitened(&self.filter, &difference);
        self.basis.iter().map(|direction| dot(direction, &white)).collect()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// What is left of a series across all directions.
fn across(basis: &[Vec<f64>], series: &[f64]) -> Vec<f64> {
    basis.iter().fold(series.to_vec(), |mut left, direction| {
        let along = dot(direction, &left);
        left.iter_mut().zip(direction).for_each(|(left, x)| *left -= along * x);
        left
    })
}

/// Gram-Schmidt, with a second pass for accuracy; zero where a series adds no direction.
fn orthonormal(series: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for one in series {
        let length = dot(one, one).sqrt();
        let mut own = across(&basis, &across(&basis, one));
        let left = dot(&own, &own).sqrt();
        let scale = if left > NEW * length { 1.0 / left } else { 0.0 };
        own.iter_mut().for_each(|x| *x *= scale);
        basis.push(own);
    }
    basis
}

/// Coefficients of the autoregressive model of a series, by the Yule-Walker equations.
fn autoregression(series: &[f64], most: usize) -> Vec<f64> {
    let n = series.len();
    let lagged = |lag: usize| dot(&series[lag..], &series[..n - lag]) / n as f64;
    let lags: Vec<f64> = (0..=most).map(lagged).collect();
    if lags[0] <= 0.0 {
        return Vec::new();
    }
    let mut best = (n as f64 * lags[0].ln(), Vec::new());
    for order in 1..=most {
        let matrix = DMatrix::from_fn(order, order, |i, j| lags[i.abs_diff(j)]);
        let right = DVector::from_fn(order, |i, _| lags[i + 1]);
        let Some(found) = matrix.cholesky().map(|cholesky| cholesky.solve(&right)) else { break };
        let variance = lags[0] - found.dot(&right);
        if variance <= 0.0 {
            break;
        }
        let criterion = n as f64 * variance.ln() + 2.0 * order as f64;
        if criterion < best.0 {
            best = (criterion, found.iter().copied().collect());
        }
    }
    best.1
}

/// A series less its prediction; the first samples, which have no full past, are left out.
fn prewhitened(filter: &[f64], series: &[f64]) -> Vec<f64> {
    let order = filter.len();
    let innovation = |at: usize| {
        series[at] - filter.iter().enumerate().map(|(lag, a)| a * series[at - 1 - lag]).sum::<f64>()
    };
    (order..series.len()).map(innovation).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Gauss;

    /// A series with the coefficients 0.6 and -0.3: they are found, and the innovations are white.
    #[test]
    fn an_autoregressive_series_is_made_white() {
        let mut random = Gauss::new(5);
        let mut series = vec![0.0, 0.0];
        for at in 2..20_000 {
            let next = 0.6 * series[at - 1] - 0.3 * series[at - 2] + random.next();
            series.push(next);
        }
        let filter = autoregression(&series, ORDER);
        assert!((filter[0] - 0.6).abs() < 0.02 && (filter[1] + 0.3).abs() < 0.02, "{filter:?}");
        let white = prewhitened(&filter, &series);
        let (zero, one) = (dot(&white, &white), dot(&white[1..], &white[..white.len() - 1]));
        assert!((zero / white.len() as f64 - 1.0).abs() < 0.03 && (one / zero).abs() < 0.02);
    }

    /// Two changes and noise of variance 0.01 in 400 samples. The coordinates of the measured
    /// record give back the sizes of the changes by least squares, within four standard errors; a
    /// third change that is the sum of both adds no direction.
    #[test]
    fn coordinates_are_those_of_least_squares() {
        let n = 400;
        let wave = |period: f64| {
            (0..n)
                .map(move |at| (std::f64::consts::TAU * f64::from(at) / period).sin())
                .collect::<Vec<f64>>()
        };
        let (a, b) = (wave(37.0), wave(90.0));
        let sum: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a + b).collect();
        let simulated = wave(11.0);
        let mut random = Gauss::new(3);
        let measured: Vec<f64> = (0..n as usize)
            .map(|at| simulated[at] + 2.0 * a[at] - 0.5 * b[at] + 0.1 * random.next())
            .collect();
        let made = Increments::new(&[a.clone(), b.clone(), sum], &simulated, &measured, None)
            .expect("long enough");
        assert!((made.variance / 0.01 - 1.0).abs() < 0.25, "{}", made.variance);
        let found = made.of(&measured).expect("the same length");
        assert_eq!(found[2], 0.0);
        let with = |sizes: [f64; 2]| {
            let values: Vec<f64> = (0..n as usize)
                .map(|at| simulated[at] + sizes[0] * a[at] + sizes[1] * b[at])
                .collect();
            made.of(&values).expect("the same length")
        };
        for (found, wanted) in found.iter().zip(with([2.0, -0.5])) {
            assert!((found - wanted).abs() < 4.0 * made.variance.sqrt(), "{found} for {wanted}");
        }
        // One per cent of gain is one hundredth of the simulated record.
        let louder: Vec<f64> = simulated.iter().map(|x| 1.01 * x).collect();
        let of_gain = made.of(&louder).expect("the same length");
        assert!(
            of_gain
                .iter()
                .zip(&made.signal)
                .all(|(found, signal)| (found - 0.01 * signal).abs() < 1e-9)
        );
        assert!(
            made.of(&measured[1..]).is_none()
                && Increments::new(&[a], &simulated[..12], &measured[..12], None).is_none()
        );
    }

    /// A change at 1.1 Hz of size 2, and a simulation that also has half as much of it at 9 Hz too
    /// little: 100 samples per second. Up to 5 Hz the size is 2 within 1 %; over all frequencies,
    /// those at 9 Hz pull at it, since the noise is small there.
    #[test]
    fn frequencies_that_the_simulation_does_not_have_do_not_count() {
        let n = 6000;
        let wave = |f: f64| {
            (0..n)
                .map(move |at| (std::f64::consts::TAU * f * f64::from(at) / 100.0).sin())
                .collect::<Vec<f64>>()
        };
        let (slow, fast) = (wave(1.1), wave(9.0));
        let change: Vec<f64> = slow.iter().zip(&fast).map(|(slow, fast)| slow + fast).collect();
        let mut random = Gauss::new(11);
        let mut drift = 0.0;
        let noise: Vec<f64> = (0..n)
            .map(|_| {
                drift = 0.98 * drift + 0.05 * random.next();
                drift
            })
            .collect();
        let measured: Vec<f64> =
            (0..n as usize).map(|at| 2.0 * slow[at] + fast[at] + noise[at]).collect();
        let simulated = vec![0.0; n as usize];
        let size = |limit: Option<Limit>| {
            let made = Increments::new(std::slice::from_ref(&change), &simulated, &measured, limit)
                .expect("long enough");
            made.of(&measured).expect("the same length")[0]
                / made.of(&change).expect("the same length")[0]
        };
        let (all, slow) = (size(None), size(Limit::new(100.0, 5.0)));
        assert!((slow - 2.0).abs() < 0.02, "{slow}");
        assert!(all < 1.95, "{all}");
        assert!(Limit::new(100.0, 30.0).is_none() && Limit::new(100.0, 0.0).is_none());
    }
}
