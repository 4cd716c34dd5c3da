//! Sections and bands, from the spectrum of the measurement.

use super::records::{Pair, Roles, Series};
use crate::diagnose::observe::layout::{Piece, Spectrum};
use crate::units::number::significant;

/// Shares of the power of the measured channels below the lowest and the highest frequency that
/// count.
const LOWEST: f64 = 0.01;
const HIGHEST: f64 = 0.99;
/// The highest frequency is below this share of the sampling rate, so that filters and bands stay
/// below half of it.
const MOST_OF_RATE: f64 = 0.4;
/// Periods of the lowest frequency in a section: fewer do not give a band power.
const PERIODS: f64 = 4.0;
/// Fewest and most sections of a campaign: with fewer nothing can be kept out of the fit, more take
/// time and tell little.
const FEWEST: usize = 6;
const MOST: usize = 24;
/// Fewest samples of a section.
const SAMPLES: usize = 64;
/// Spectral lines of a section in its lowest band, at least.
const LINES: f64 = 2.0;
/// The lowest band starts at this share of the lowest frequency: a cause may act where the motion
/// has little power.
const BELOW: f64 = 0.25;
/// Ratio of the edges of a band, about, and the most bands.
const RATIO: f64 = 2.0;
const BANDS: usize = 5;
/// Distance of sections from the ends of a record, and the record around a section, as shares of
/// its length.
const MARGIN: f64 = 0.05;
const AROUND: f64 = 0.25;
/// Steps in which a spectrum is added up, from its lowest to its highest frequency.
const STEPS: usize = 120;

/// A section of a pair, on the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    pub pair: usize,
    pub start: f64,
    pub end: f64,
    /// Range of its records.
    pub from: f64,
    pub to: f64,
}

/// Frequencies and sections of a campaign.
#[derive(Clone, Debug)]
pub struct Cut {
    pub over_distance: bool,
    pub windows: Vec<Window>,
    /// Edges of the bands in Hz.
    pub edges: Vec<f64>,
    /// Lowest and highest frequency of the content in Hz.
    pub content: (f64, f64),
    /// Largest lag that is searched, in the unit of the axis.
    pub furthest: f64,
    /// Distance of two samples on the axis.
    pub step: f64,
}

/// Cuts all pairs.
pub fn cut(pairs: &[Pair], roles: &Roles) -> Cut {
    let over_distance = pairs.iter().all(Pair::over_distance);
    let content = content(pairs, roles);
    let lasts: Vec<f64> = pairs.iter().map(|pair| seconds(pair, over_distance)).collect();
    let total: f64 = lasts.iter().sum();
    let fastest = pairs.iter().map(|pair| pair.measured.step()).fold(f64::INFINITY, f64::min);
    let wanted = (total * content.0 / PERIODS).floor().clamp(FEWEST as f64, MOST as f64);
    let samples = SAMPLES as f64 * fastest;
    let mut windows = Vec::new();
    let mut shortest = f64::INFINITY;
    for (at, pair) in pairs.iter().enumerate() {
        let count =
            (wanted * lasts[at] / total).round().min((lasts[at] / samples).floor()).max(1.0);
        let (first, last) = pair.common(over_distance);
        let length = (last - first) / (count + 2.0 * MARGIN);
        shortest = shortest.min(lasts[at] / (count + 2.0 * MARGIN));
        for n in 0..count as usize {
            let start = first + (n as f64 + MARGIN) * length;
            let (start, end) = (rounded(start), rounded(start + length));
            let around = AROUND * length;
            windows.push(Window {
                pair: at,
                start,
                end,
                from: (start - around).max(first),
                to: (end + around).min(last),
            });
        }
    }
    let edges = edges(content, LINES / shortest);
    let long = |pair: &Pair| {
        let (first, last) = pair.common(over_distance);
        last - first
    };
    let per_second = pairs.iter().map(long).sum::<f64>() / total;
    let furthest = two_digits((0.1 * shortest).min(0.25 / content.0) * per_second);
    Cut { over_distance, windows, edges, content, furthest, step: fastest * per_second }
}

/// Duration of the common range of a pair in s.
fn seconds(pair: &Pair, over_distance: bool) -> f64 {
    let (from, to) = pair.common(over_distance);
    let axis = pair.measured.axis(over_distance);
    let inside = axis.iter().filter(|x| (from..=to).contains(*x)).count();
    (inside as f64 * pair.measured.step()).max(f64::MIN_POSITIVE)
}

/// The samples of a channel in a range of the axis.
pub fn piece(
    series: &Series,
    name: &str,
    over_distance: bool,
    from: f64,
    to: f64,
) -> Option<Piece> {
    let axis = series.axis(over_distance);
    let (a, b) = (axis.partition_point(|x| *x < from), axis.partition_point(|x| *x <= to));
    let values = series.channel(name)?.values.get(a..b)?.to_vec();
    if values.len() < 16 {
        return None;
    }
    let step = (axis[b - 1] - axis[a]) / (b - a - 1) as f64;
    Some(Piece { values, rate: 1.0 / series.step(), step })
}

/// The widest range of frequencies that a compared channel has content in.
fn content(pairs: &[Pair], roles: &Roles) -> (f64, f64) {
    let slowest = pairs.iter().map(|pair| pair.measured.step()).fold(0.0, f64::max);
    let top = MOST_OF_RATE / slowest;
    let (mut low, mut high) = (top, 0.0_f64);
    for pair in pairs {
        let (from, to) = pair.common(false);
        for name in &roles.outputs {
            let Some(piece) = piece(&pair.measured, name, false, from, to) else { continue };
            let bottom = 1.0 / (piece.values.len() as f64 / piece.rate);
            let spectrum = Spectrum::new(&piece);
            let edge = |n: usize| bottom * (top / bottom).powf(n as f64 / STEPS as f64);
            let powers: Vec<f64> =
                (0..STEPS).map(|n| spectrum.power(edge(n), edge(n + 1))).collect();
            let all: f64 = powers.iter().sum();
            let reaches = |share: f64| {
                let mut sum = 0.0;
                let found = powers.iter().position(|power| {
                    sum += power;
                    sum >= share * all
                });
                found.unwrap_or(STEPS - 1)
            };
            low = low.min(edge(reaches(LOWEST)));
            high = high.max(edge(reaches(HIGHEST) + 1));
        }
    }
    let high = high.clamp(0.0, top);
    (low.min(high / RATIO), high)
}

/// Edges of bands of about the same ratio, in two digits; the lowest band has at least `least` Hz
/// below it.
fn edges((low, high): (f64, f64), least: f64) -> Vec<f64> {
    let low = (BELOW * low).max(least).min(high / RATIO);
    let count = ((high / low).ln() / RATIO.ln()).round().clamp(1.0, BANDS as f64);
    let mut edges: Vec<f64> = (0..=count as usize)
        .map(|n| two_digits(low * (high / low).powf(n as f64 / count)))
        .collect();
    edges.dedup();
    edges
}

/// Rounded to two significant digits.
pub fn two_digits(value: f64) -> f64 {
    significant(value, 2)
}

/// Starts and ends have a thousandth of a second or a millimetre.
fn rounded(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From 0.5 to 32 Hz there are six octaves, of which five bands are made; a section of 4 s
    /// resolves 0.5 Hz.
    #[test]
    fn bands_are_about_octaves_above_what_a_section_resolves() {
        assert_eq!(edges((2.0, 32.0), 0.5), [0.5, 1.1, 2.6, 6.1, 14.0, 32.0]);
        assert_eq!(edges((2.0, 32.0), 8.0), [8.0, 16.0, 32.0]);
        assert_eq!(edges((30.0, 32.0), 0.5), [7.5, 15.0, 32.0]);
        assert_eq!(two_digits(0.001_234), 0.0012);
    }
}
