//! Allowances of features, from repeats or from the scatter of the differences.

use super::{
    records::{Pair, Roles},
    windows::{Cut, piece, two_digits},
};
use crate::diagnose::observe::layout::{Spectrum, level};

/// Bounds of the standard deviations: a level as a share of the rms value of its channel, a band as
/// a logarithm, a gain, and a lag in samples. Below, an allowance would claim more than a record of
/// this length can show; above, it would hide every effect.
const LEVEL: (f64, f64) = (0.005, 0.1);
const BAND: (f64, f64) = (0.03, 0.3);
const GAIN: (f64, f64) = (0.01, 0.15);
const LAG: (f64, f64) = (0.25, 5.0);
/// Fewest differences from which a scatter is estimated.
const FEWEST: usize = 3;
/// Without that many: the geometric middle of the bounds.
const NORMAL: f64 = 1.4826;
/// Relative rms difference of two simulated records below which their runs are repeats of each
/// other.
const REPEAT: f64 = 0.01;

/// One standard deviation of each kind of feature of a channel in one section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Allowance {
    pub level: f64,
    pub band: f64,
    pub gain: f64,
    pub lag: f64,
    /// White noise per sample.
    pub noise: f64,
    /// Root mean square and largest absolute value of the measurement.
    pub rms: f64,
    pub peak: f64,
}

/// Differences of one section and channel: level, bands, gain and lag.
struct Difference {
    level: f64,
    bands: Vec<f64>,
    gain: f64,
    lag: f64,
}

/// Allowances of the compared channels, and what they were estimated from.
pub fn allowances(pairs: &[Pair], roles: &Roles, cut: &Cut) -> (Vec<Allowance>, String) {
    let repeats = repeats(pairs, roles, cut);
    let of_repeats = !repeats.is_empty();
    let neighbours = |at: &usize| {
        let next = cut.windows.get(at + 1);
        next.is_some_and(|next| next.pair == cut.windows[*at].pair)
    };
    let couples: Vec<(usize, usize)> = if of_repeats {
        repeats
    } else {
        (0..cut.windows.len()).filter(neighbours).map(|at| (at, at + 1)).collect()
    };
    let mut counted = 0;
    let allowance = |name: &String| {
        let of: Vec<Option<Difference>> =
            (0..cut.windows.len()).map(|at| difference(pairs, cut, name, at)).collect();
        let both: Vec<(&Difference, &Difference)> =
            couples.iter().filter_map(|(a, b)| of[*a].as_ref().zip(of[*b].as_ref())).collect();
        counted = counted.max(both.len());
        let scatter = |of: &dyn Fn(&Difference) -> Vec<f64>| {
            let off = both.iter().flat_map(|(a, b)| {
                of(a).into_iter().zip(of(b)).map(|(a, b)| (a - b).abs()).collect::<Vec<_>>()
            });
            median(off.collect())
                .filter(|_| both.len() >= FEWEST)
                .map(|median| NORMAL * median / std::f64::consts::SQRT_2)
        };
        let (rms, peak) = size(pairs, name);
        let bounded = |found: Option<f64>, (low, high): (f64, f64), scale: f64| {
            let value = found.map_or((low * high).sqrt(), |found| {
                (found / scale.max(f64::MIN_POSITIVE)).clamp(low, high)
            });
            two_digits(value * scale)
        };
        Allowance {
            level: bounded(scatter(&|of| vec![of.level]), LEVEL, rms),
            band: bounded(scatter(&|of| of.bands.clone()), BAND, 1.0),
            gain: bounded(scatter(&|of| vec![of.gain]), GAIN, 1.0),
            lag: bounded(scatter(&|of| vec![of.lag]), LAG, cut.step),
            noise: two_digits(noise(pairs, name, cut).max(1e-4 * rms)),
            rms,
            peak,
        }
    };
    let all = roles.outputs.iter().map(allowance).collect();
    let from = match (counted >= FEWEST, of_repeats) {
        (false, _) => {
            "Too few sections for a scatter: the standard deviations are placeholders.".to_string()
        }
        (true, true) => format!("Standard deviations from {counted} repeated sections."),
        (true, false) => format!(
            "Standard deviations from the scatter of the differences of {counted} neighbouring sections."
        ),
    };
    (all, from)
}

fn difference(pairs: &[Pair], cut: &Cut, name: &str, at: usize) -> Option<Difference> {
    let window = cut.windows[at];
    let pair = &pairs[window.pair];
    let of = |series| piece(series, name, cut.over_distance, window.start, window.end);
    let (mut simulated, mut measured) = (of(&pair.simulated)?, of(&pair.measured)?);
    let count = simulated.values.len().min(measured.values.len());
    simulated.values.truncate(count);
    measured.values.truncate(count);
    let (a, b) = (Spectrum::new(&simulated), Spectrum::new(&measured));
    let band = |edges: &[f64]| {
        0.5 * (b.power(edges[0], edges[1]).max(1e-300) / a.power(edges[0], edges[1]).max(1e-300))
            .ln()
    };
    let alike = (cut.edges[0], cut.edges[cut.edges.len() - 1]);
    let (gain, lag) = b.alike(&a, alike, (cut.furthest / cut.step.max(f64::MIN_POSITIVE)) as usize);
    Some(Difference {
        level: level(&measured.values)? - level(&simulated.values)?,
        bands: cut.edges.windows(2).map(band).collect(),
        gain,
        lag: lag * cut.step,
    })
}

/// Sections of runs with the same simulation, as couples.
fn repeats(pairs: &[Pair], roles: &Roles, cut: &Cut) -> Vec<(usize, usize)> {
    let alike = |a: &Pair, b: &Pair| {
        roles.outputs.iter().all(|name| {
            let (Some(a), Some(b)) = (a.simulated.channel(name), b.simulated.channel(name)) else {
                return false;
            };
            let off: f64 = a.values.iter().zip(&b.values).map(|(a, b)| (a - b).powi(2)).sum();
            let all: f64 = a.values.iter().map(|a| a * a).sum();
            a.values.len() == b.values.len() && off <= REPEAT * REPEAT * all
        })
    };
    let of = |pair: usize| {
        cut.windows
            .iter()
            .enumerate()
            .filter(move |(_, window)| window.pair == pair)
            .map(|(at, _)| at)
    };
    let mut found = Vec::new();
    for first in 0..pairs.len() {
        for second in first + 1..pairs.len() {
            if alike(&pairs[first], &pairs[second]) {
                found.extend(of(first).zip(of(second)));
            }
        }
    }
    found
}

/// Root mean square and largest absolute value of a measured channel.
fn size(pairs: &[Pair], name: &str) -> (f64, f64) {
    let values = || {
        pairs
            .iter()
            .filter_map(|pair| pair.measured.channel(name))
            .flat_map(|channel| channel.values.iter().copied())
    };
    let squares: f64 = values().map(|value| value * value).sum();
    (
        (squares / values().count().max(1) as f64).sqrt(),
        values().fold(0.0, |peak: f64, value| peak.max(value.abs())),
    )
}

/// White noise of a channel: its power between the content and half the sampling rate, spread over
/// the whole range.
fn noise(pairs: &[Pair], name: &str, cut: &Cut) -> f64 {
    let of = |pair: &Pair| {
        let (from, to) = pair.common(false);
        let piece = piece(&pair.measured, name, false, from, to)?;
        let half = 0.5 * piece.rate;
        let low = (RISES * cut.content.1).min(0.9 * half);
        Some(Spectrum::new(&piece).power(low, half) / (half - low) * half)
    };
    median(pairs.iter().filter_map(of).collect()).unwrap_or(0.0).sqrt()
}

/// Noise is taken from this many times the highest frequency of the content on.
const RISES: f64 = 2.0;

fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len().checked_sub(1)? / 2;
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}
