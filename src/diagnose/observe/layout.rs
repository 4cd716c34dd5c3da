//! Features of a record: levels, band powers, gains and lags of its channels.
//!
//! Features of a channel depend on that channel alone, and on the simulated one for gains and lags.
//! An operation on one channel therefore changes the features of that channel only.

use crate::diagnose::levels::features::{INVERTED, SPIKES};
use crate::metrics::fourier;
use crate::units::Unit;

/// Band edges and channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    pub channels: Vec<ChannelFeatures>,
    /// Edges of the bands in Hz, increasing; the number of bands is one less.
    pub edges: Vec<f64>,
    /// Band in Hz in which gain and lag are estimated.
    pub alike: (f64, f64),
    /// The largest lag searched, in the unit of the axis.
    pub furthest: f64,
}

/// To be changed whenever the definition of a feature changes: features in caches are then computed
/// again.
pub const VERSION: &str = "levels are means; samples up to the highest band";

/// The features of one channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelFeatures {
    pub name: String,
    /// Number of its group of channels.
    pub group: usize,
    /// Unit of its levels.
    pub unit: Unit,
    /// Whether its level is a feature.
    pub level: bool,
    /// The number of bands that are features, from the lowest.
    pub bands: usize,
    /// Whether gain and lag against the simulation are features.
    pub alike: bool,
    /// Number of effects whose changes are compared sample by sample.
    pub increments: usize,
}

/// Kind of a feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// Winsorised mean, in the unit of the channel.
    Level,
    /// Natural logarithm of the rms in a band.
    Band(usize),
    /// Regression coefficient of the record on the simulation; 1 where they agree.
    Gain,
    /// Distance of the record behind the simulation, in the unit of the axis.
    Lag,
    /// Coordinate of the difference of the records along the changes that the effects cause, sample
    /// by sample.
    Increment(usize),
}

/// A feature of the layout: channel number and kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Feature {
    pub channel: usize,
    pub kind: Kind,
}

impl Layout {
    /// All features of a section, channel by channel.
    pub fn features(&self) -> Vec<Feature> {
        let mut features = Vec::new();
        for (channel, of) in self.channels.iter().enumerate() {
            let mut push = |kind| features.push(Feature { channel, kind });
            if of.level {
                push(Kind::Level);
            }
            (0..of.bands).for_each(|band| push(Kind::Band(band)));
            if of.alike {
                push(Kind::Gain);
                push(Kind::Lag);
            }
            (0..of.increments).for_each(|at| push(Kind::Increment(at)));
        }
        features
    }
}

/// The samples of one channel inside a section.
#[derive(Clone, Debug)]
pub struct Piece {
    /// Samples at a constant rate.
    pub values: Vec<f64>,
    /// Samples per s.
    pub rate: f64,
    /// Distance of two samples on the axis.
    pub step: f64,
}

/// The tapered spectrum of a piece without its mean.
#[derive(Clone, Debug)]
pub struct Spectrum {
    lines: Vec<(f64, f64)>,
    /// Distance of spectral lines in Hz.
    width: f64,
    /// Factor from the squared magnitude of a line to power.
    scale: f64,
    padded: usize,
}

/// Winsorised mean (Dixon 1960): the lowest and the highest hundredth of the samples are replaced
/// by the next value inside, so that single spikes have no influence. For an oscillating signal it
/// scatters two to four times less than the median, since whole periods cancel. `None` of an empty
/// slice.
pub fn level(values: &[f64]) -> Option<f64> {
    let last = values.len().checked_sub(1)?;
    let out = (SPIKES * values.len() as f64) as usize;
    let mut sorted = values.to_vec();
    let (_, low, above) = sorted.select_nth_unstable_by(out, f64::total_cmp);
    let low = *low;
    let high = if above.is_empty() {
        low
    } else {
        *above.select_nth_unstable_by((last - 2 * out).saturating_sub(1), f64::total_cmp).1
    };
    Some(
        values.iter().map(|value| value.clamp(low, high.max(low))).sum::<f64>()
            / values.len() as f64,
    )
}

impl Spectrum {
    /// Spectrum with a Hann taper, padded to a power of two of at least twice the length, so that
    /// correlations do not wrap around.
    pub fn new(piece: &Piece) -> Self {
        let n = piece.values.len();
        let padded = (2 * n.max(8)).next_power_of_two();
        let mean = piece.values.iter().sum::<f64>() / n.max(1) as f64;
        // The linear trend is removed, since it would leak into the bands.
        let middle = 0.5 * (n.max(1) - 1) as f64;
        let (mut up, mut down) = (0.0, 0.0);
        for (i, value) in piece.values.iter().enumerate() {
            let x = i as f64 - middle;
            up += x * (value - mean);
            down += x * x;
        }
        let slope = if down > 0.0 { up / down } else { 0.0 };
        let mut input = vec![0.0; padded];
        let mut power = 0.0;
        for (i, value) in piece.values.iter().enumerate() {
            let taper = (std::f64::consts::PI * (i as f64 + 0.5) / n as f64).sin().powi(2);
            input[i] = (value - mean - slope * (i as f64 - middle)) * taper;
            power += taper * taper;
        }
        let transform = fourier::forward(padded);
        let mut output = transform.make_output_vec();
        // The lengths are those of the plan: the call cannot fail.
        let _ = transform.process(&mut input, &mut output);
        let lines = output.into_iter().map(|line| (line.re, line.im)).collect();
        Self {
            lines,
            width: piece.rate / padded as f64,
            scale: 2.0 / (power.max(1e-300) * padded as f64),
            padded,
        }
    }

    fn range(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        let from = (low / self.width).ceil().max(1.0) as usize;
        let to = (high / self.width).ceil() as usize;
        from.min(self.lines.len())..to.clamp(from, self.lines.len().max(from)).min(self.lines.len())
    }

    /// Mean square between two frequencies in Hz.
    pub fn power(&self, low: f64, high: f64) -> f64 {
        self.lines[self.range(low, high)].iter().map(|(re, im)| re * re + im * im).sum::<f64>()
            * self.scale
    }

    /// Regression of `self` on `reference` over a band: the gain, and the lag in samples of the
    /// largest correlation, of either sign.
    pub fn alike(&self, reference: &Self, band: (f64, f64), furthest: usize) -> (f64, f64) {
        self.correlated(reference, band, furthest)
            .map_or((0.0, 0.0), |alike| (alike.gain(), alike.lag()))
    }

    /// The second-largest peak of the correlation as a share of the largest. Near 1, the lag is not
    /// unique, as for a slow periodic motion.
    pub fn next_best(&self, reference: &Self, band: (f64, f64), furthest: usize) -> f64 {
        self.correlated(reference, band, furthest).map_or(0.0, |alike| alike.next_best())
    }

    fn correlated(
        &self,
        reference: &Self,
        (low, high): (f64, f64),
        furthest: usize,
    ) -> Option<Correlated> {
        if self.padded != reference.padded {
            return None;
        }
        let inverse = fourier::inverse(self.padded);
        let mut cross = inverse.make_input_vec();
        let mut own = 0.0;
        for i in reference.range(low, high) {
            let ((a, b), (c, d)) = (self.lines[i], reference.lines[i]);
            cross[i].re = a * c + b * d;
            cross[i].im = b * c - a * d;
            own += c * c + d * d;
        }
        let mut values = inverse.make_output_vec();
        // The lengths are those of the plan: the call cannot fail.
        let _ = inverse.process(&mut cross, &mut values);
        Some(Correlated {
            values,
            own,
            furthest: (furthest as i64).min(self.padded as i64 / 2 - 2),
        })
    }
}

/// Cross-correlation of two records at every lag.
struct Correlated {
    values: Vec<f64>,
    /// Autocorrelation of the reference at lag 0.
    own: f64,
    furthest: i64,
}

impl Correlated {
    fn at(&self, lag: i64) -> f64 {
        // The transform covers one-sided lines: the correlation is half the sum.
        self.values[lag.rem_euclid(self.values.len() as i64) as usize] * 0.5
    }

    fn gain(&self) -> f64 {
        self.at(0) / self.own.max(1e-300)
    }

    /// The lag of the largest correlation, and -1 if that is negative.
    fn best(&self) -> (i64, f64) {
        let signed = |sign: f64| {
            move |a: &i64, b: &i64| (sign * self.at(*a)).total_cmp(&(sign * self.at(*b)))
        };
        let most = |sign: f64| (-self.furthest..=self.furthest).max_by(signed(sign)).unwrap_or(0);
        let (upright, inverted) = (most(1.0), most(-1.0));
        if -self.at(inverted) > INVERTED * self.at(upright) {
            (inverted, -1.0)
        } else {
            (upright, 1.0)
        }
    }

    /// The same, interpolated between samples.
    fn lag(&self) -> f64 {
        let (best, sign) = self.best();
        let [left, middle, right] = [-1, 0, 1].map(|by| sign * self.at(best + by));
        let bend = left - 2.0 * middle + right;
        best as f64 + if bend < 0.0 { (0.5 * (left - right) / bend).clamp(-0.5, 0.5) } else { 0.0 }
    }

    fn next_best(&self) -> f64 {
        let (best, sign) = self.best();
        let beyond = |by: i64| {
            let lags = move || {
                std::iter::successors(Some(best), move |lag| Some(lag + by))
                    .take_while(|lag| lag.abs() <= self.furthest)
            };
            // Skip the peak: down to where the correlation rises again.
            let down = lags()
                .zip(lags().skip(1))
                .take_while(|(a, b)| sign * self.at(*b) < sign * self.at(*a))
                .count();
            lags().skip(down).map(|lag| sign * self.at(lag)).fold(0.0, f64::max)
        };
        (beyond(-1).max(beyond(1)) / (sign * self.at(best)).max(1e-300)).min(1.0)
    }
}

/// Appends the features of one channel, in the order of [`Layout::features`].
///
/// `reference` is the spectrum of the simulated channel. `noise` is the standard deviation per
/// sample of white noise whose power is added, in the unit of the channel. `shift` is the distance
/// of the piece's axis behind that of the reference.
pub fn of_channel(
    layout: &Layout,
    of: &ChannelFeatures,
    piece: &Piece,
    reference: Option<&Spectrum>,
    noise: f64,
    out: &mut Vec<f64>,
) {
    if of.level {
        out.push(level(&piece.values).unwrap_or(0.0));
    }
    if of.bands == 0 && !of.alike {
        return;
    }
    let spectrum = Spectrum::new(piece);
    for band in 0..of.bands {
        let (low, high) = (layout.edges[band], layout.edges[band + 1]);
        let white = noise * noise * (high - low) / (0.5 * piece.rate);
        out.push(0.5 * (spectrum.power(low, high) + white + 1e-12).ln());
    }
    if of.alike {
        let (gain, lag) = match reference {
            Some(reference) => spectrum.alike(
                reference,
                layout.alike,
                (layout.furthest / piece.step.max(1e-9)) as usize,
            ),
            None => (1.0, 0.0),
        };
        out.push(gain);
        out.push(lag * piece.step);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(frequency: f64, amplitude: f64, delay: usize) -> Piece {
        let values = (0..2000).map(|n| {
            amplitude
                * (std::f64::consts::TAU * frequency * (n as f64 - delay as f64) / 200.0).sin()
                + 3.0
        });
        Piece { values: values.collect(), rate: 200.0, step: 0.1 }
    }

    /// A sine of amplitude 2 has a mean square of 2, all of it in its band.
    #[test]
    fn power_of_a_sine() {
        let spectrum = Spectrum::new(&sine(3.0, 2.0, 0));
        assert!((spectrum.power(2.0, 4.0) - 2.0).abs() < 0.01, "{}", spectrum.power(2.0, 4.0));
        assert!(spectrum.power(6.0, 20.0) < 1e-6);
    }

    #[test]
    fn gain_and_lag_of_a_delayed_copy() {
        let (a, b) = (Spectrum::new(&sine(3.0, 2.0, 0)), Spectrum::new(&sine(3.0, 3.0, 7)));
        let (_, lag) = b.alike(&a, (1.0, 8.0), 30);
        assert!((lag - 7.0).abs() < 0.05, "{lag}");
        // Inverted; half a period is 33 samples.
        let (gain, lag) = Spectrum::new(&sine(3.0, -3.0, 0)).alike(&a, (1.0, 8.0), 20);
        assert!((gain + 1.5).abs() < 1e-3, "{gain}");
        assert!(lag.abs() < 0.05, "{lag}");
    }

    /// A sine correlates with itself after one period, except for the taper.
    #[test]
    fn what_comes_again_has_another_lag() {
        let long = Spectrum::new(&sine(1.0, 2.0, 0));
        let again = long.next_best(&long, (0.5, 8.0), 400);
        // The Hann taper over 10 s, correlated with itself at a lag of 1 s.
        let tapered = |n: usize| (std::f64::consts::PI * (n as f64 + 0.5) / 2000.0).sin().powi(2);
        let wanted = (0..1800).map(|n| tapered(n) * tapered(n + 200)).sum::<f64>()
            / (0..2000).map(|n| tapered(n).powi(2)).sum::<f64>();
        assert!((again - wanted).abs() < 0.01, "{again} for {wanted}");
        assert_eq!(long.next_best(&long, (0.5, 8.0), 60), 0.0);
    }

    /// 200 values of which two at either end are replaced: 2, 2, 2, 3, ..., 197, 197, 197; their
    /// own values have no influence.
    #[test]
    fn levels() {
        let mut values: Vec<f64> = (0..200).map(f64::from).collect();
        let mean = values.iter().sum::<f64>() / 200.0;
        values[199] = 1e9;
        values[0] = -1e6;
        values.swap(3, 199);
        assert_eq!(level(&values), Some(mean));
        assert_eq!(level(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!((level(&[]), level(&[5.0])), (None, Some(5.0)));
    }
}
