//! Effects of the measuring chain: exact operations on recorded signals.

use super::{expression::Formula, signals::Signals};
use crate::metrics::filter::{Band, Cutoff, Filter, Phase};
use crate::yaml::Words;

/// An operation on channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Operator {
    /// Adds a share of the partner channel. First in the chain.
    Crosstalk,
    /// Causal second-order low-pass, initialised in the steady state of the first sample.
    LowPass,
    Gain,
    Polarity,
    Offset,
    /// Increases linearly with time from the start of the record.
    Drift,
    Noise,
    /// Limits the values to a bound.
    Clip,
    /// Exchanges pairs of channels.
    Swap,
    /// Shifts the recorded position against the true one. Last in the chain.
    Shift,
}

impl Words for Operator {
    const CODE: &'static str = "unknown-operator";
    const WORDS: &'static [(&'static str, Self)] = &[
        ("crosstalk", Self::Crosstalk),
        ("low-pass", Self::LowPass),
        ("gain", Self::Gain),
        ("polarity", Self::Polarity),
        ("offset", Self::Offset),
        ("drift", Self::Drift),
        ("noise", Self::Noise),
        ("clip", Self::Clip),
        ("swap", Self::Swap),
        ("shift", Self::Shift),
    ];
}

/// Order of the low-pass.
const LOW_PASS_ORDER: usize = 2;

impl Signals {
    /// Replaces channels by formulas of the original channels; formulas with a channel that the
    /// record does not have are skipped.
    ///
    /// # Errors
    /// A value is not finite; a message.
    pub fn compute(&mut self, formulas: &[Formula], parameters: &[f64]) -> Result<(), String> {
        let mut made = Vec::new();
        for formula in formulas {
            let values = formula.values(self, parameters);
            if let Some((at, values)) = self.position(&formula.channel).zip(values) {
                made.push((at, values?));
            }
        }
        made.into_iter().for_each(|(at, values)| self.channels[at].values = values);
        Ok(())
    }

    /// Applies an operator with its value to channels; channels that the record does not have are
    /// skipped.
    ///
    /// For [`Operator::Crosstalk`] and [`Operator::Swap`] the channels are pairs: the changed
    /// channel and its partner. `seed` makes the noise reproducible; it depends on the section.
    ///
    /// # Errors
    /// The low-pass is not possible at this sampling rate; a message.
    pub fn apply(
        &mut self,
        operator: Operator,
        value: f64,
        channels: &[String],
        seed: u64,
    ) -> Result<(), String> {
        let positions: Vec<usize> =
            channels.iter().filter_map(|name| self.position(name)).collect();
        let pairs = channels.chunks_exact(2);
        let pairs = pairs.filter_map(|pair| self.position(&pair[0]).zip(self.position(&pair[1])));
        match operator {
            Operator::Shift => self.axis.iter_mut().for_each(|x| *x += value),
            Operator::Swap => {
                for (a, b) in pairs.collect::<Vec<_>>() {
                    let values = std::mem::take(&mut self.channels[a].values);
                    self.channels[a].values =
                        std::mem::replace(&mut self.channels[b].values, values);
                }
            }
            Operator::Crosstalk => {
                for (to, from) in pairs.collect::<Vec<_>>() {
                    let partner = self.channels[from].values.clone();
                    let values = self.channels[to].values.iter_mut();
                    values.zip(partner).for_each(|(x, y)| *x += value * y);
                }
            }
            Operator::LowPass => {
                let band = Band::LowPass(value);
                let (causal, per_pass) = (Phase::Causal, Cutoff::PerPass);
                let filter = Filter::design(band, LOW_PASS_ORDER, self.rate, causal, per_pass);
                let filter = filter.map_err(|error| error.to_string())?;
                for at in positions {
                    let values = &mut self.channels[at].values;
                    *values = filter.apply(values).map_err(|error| error.to_string())?;
                }
            }
            _ => {
                for at in positions {
                    let seed = seed ^ (at as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
                    each(operator, value, &mut self.channels[at].values, self.rate, seed);
                }
            }
        }
        Ok(())
    }
}

fn each(operator: Operator, value: f64, values: &mut [f64], rate: f64, seed: u64) {
    match operator {
        Operator::Gain | Operator::Polarity => values.iter_mut().for_each(|x| *x *= value),
        Operator::Offset => values.iter_mut().for_each(|x| *x += value),
        Operator::Drift => {
            values.iter_mut().enumerate().for_each(|(n, x)| *x += value * n as f64 / rate)
        }
        Operator::Clip => values.iter_mut().for_each(|x| *x = x.clamp(-value, value)),
        Operator::Noise => {
            let mut noise = Gauss::new(seed);
            values.iter_mut().for_each(|x| *x += value * noise.next());
        }
        Operator::Crosstalk | Operator::LowPass | Operator::Swap | Operator::Shift => {}
    }
}

/// Random numbers, reproducible from a seed on every machine.
#[derive(Clone, Debug)]
pub struct Gauss(fastrand::Rng);

impl Gauss {
    pub fn new(seed: u64) -> Self {
        Self(fastrand::Rng::with_seed(seed))
    }

    /// Uniform between 0 and 1, both excluded.
    pub fn uniform(&mut self) -> f64 {
        self.0.f64().max(f64::MIN_POSITIVE)
    }

    /// A uniform integer below `bound`.
    pub fn below(&mut self, bound: usize) -> usize {
        self.0.usize(..bound)
    }

    /// Normal with mean 0 and standard deviation 1.
    #[allow(clippy::should_implement_trait)]
    pub fn next(&mut self) -> f64 {
        // The inverse of the distribution: quantile(p) = -sqrt(2) erfc^-1(2 p).
        -std::f64::consts::SQRT_2 * statrs::function::erf::erfc_inv(2.0 * self.uniform())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::signals::Channel;

    fn two() -> Signals {
        let channel =
            |name: &str, values: &[f64]| Channel { name: name.into(), values: values.to_vec() };
        Signals {
            axis: vec![0.0, 1.0, 2.0],
            over_time: false,
            rate: 2.0,
            channels: vec![channel("a", &[1.0, 2.0, 3.0]), channel("b", &[4.0, -5.0, 6.0])],
        }
    }

    fn after(operator: Operator, value: f64, channels: &[&str]) -> Vec<Vec<f64>> {
        let mut signals = two();
        let channels: Vec<String> = channels.iter().map(ToString::to_string).collect();
        signals.apply(operator, value, &channels, 1).expect("applies");
        signals.channels.into_iter().map(|channel| channel.values).collect()
    }

    #[test]
    fn operators_by_hand() {
        let untouched = vec![4.0, -5.0, 6.0];
        assert_eq!(after(Operator::Gain, 2.0, &["a"]), [vec![2.0, 4.0, 6.0], untouched.clone()]);
        assert_eq!(
            after(Operator::Polarity, -1.0, &["a"]),
            [vec![-1.0, -2.0, -3.0], untouched.clone()]
        );
        assert_eq!(after(Operator::Offset, 0.5, &["a"]), [vec![1.5, 2.5, 3.5], untouched.clone()]);
        assert_eq!(after(Operator::Drift, 4.0, &["a"]), [vec![1.0, 4.0, 7.0], untouched.clone()]);
        assert_eq!(after(Operator::Clip, 4.5, &["b"]), [vec![1.0, 2.0, 3.0], vec![4.0, -4.5, 4.5]]);
        assert_eq!(
            after(Operator::Swap, 1.0, &["a", "b"]),
            [untouched.clone(), vec![1.0, 2.0, 3.0]]
        );
        assert_eq!(after(Operator::Crosstalk, 0.1, &["a", "b"]), [vec![1.4, 1.5, 3.6], untouched]);
    }

    /// Mean and variance of a hundred thousand numbers are within four standard errors.
    #[test]
    fn noise_is_normal() {
        let mut gauss = Gauss::new(7);
        let values: Vec<f64> = (0..100_000).map(|_| gauss.next()).collect();
        let mean = values.iter().sum::<f64>() / 1e5;
        let variance = values.iter().map(|x| x * x).sum::<f64>() / 1e5;
        assert!(
            mean.abs() < 4.0 / 1e5_f64.sqrt()
                && (variance - 1.0).abs() < 4.0 * (2.0_f64 / 1e5).sqrt()
        );
    }
}
