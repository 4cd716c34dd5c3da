//! Scatter of the features of a single channel and section.

use crate::diagnose::levels::scatter::{AS_ALIKE, BLOCK, DRAWS};
use crate::diagnose::observe::layout::{Layout, Piece, Spectrum, level};
use crate::effects::Gauss;

/// Scatter of the features of one channel in one section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scatter {
    /// Variance of measured - simulated level, in the square of the channel's unit.
    pub level: f64,
    /// Whether the lag is unique; that of a slow periodic motion is not.
    pub has_lag: bool,
}

/// Estimates it from the measured and the simulated piece.
pub fn scatter(
    layout: &Layout,
    measured: &Piece,
    simulated: &Piece,
    reference: &Spectrum,
    seed: u64,
) -> Scatter {
    let spectrum = Spectrum::new(measured);
    let furthest = (layout.furthest / measured.step.max(1e-9)) as usize;
    let pairs = [(&spectrum, reference), (&spectrum, &spectrum), (reference, reference)];
    let again =
        pairs.iter().map(|(a, b)| a.next_best(b, layout.alike, furthest)).fold(0.0, f64::max);
    Scatter { level: of_levels(measured, simulated, seed), has_lag: again < AS_ALIKE }
}

/// Variance of the difference of two levels by a moving-block bootstrap with common blocks (Künsch
/// 1989).
fn of_levels(measured: &Piece, simulated: &Piece, seed: u64) -> f64 {
    let sides =
        [measured, simulated].map(|piece| (&piece.values, ((BLOCK * piece.rate) as usize).max(1)));
    if sides.iter().any(|(values, block)| values.len() <= *block) {
        return 0.0;
    }
    let count = measured.values.len().div_ceil(sides[0].1);
    let mut random =
        Gauss::new(seed.wrapping_mul(0x5851_F42D_4C95_7F2D) ^ measured.values.len() as u64);
    let mut draw = || {
        let starts: Vec<f64> =
            (0..count).map(|_| random.below(1 << 20) as f64 / f64::from(1 << 20)).collect();
        let [measured, simulated] = sides.each_ref().map(|(values, block)| {
            let from = |start: &f64| (start * (values.len() - block + 1) as f64) as usize;
            let drawn: Vec<f64> = starts
                .iter()
                .flat_map(|start| &values[from(start)..from(start) + block])
                .copied()
                .collect();
            level(&drawn).unwrap_or(0.0)
        });
        measured - simulated
    };
    let levels: Vec<f64> = (0..DRAWS).map(|_| draw()).collect();
    let mean = levels.iter().sum::<f64>() / DRAWS as f64;
    levels.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (DRAWS - 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(seed: u64) -> Piece {
        let mut random = Gauss::new(seed);
        Piece { values: (0..4000).map(|_| random.next()).collect(), rate: 200.0, step: 0.1 }
    }

    /// The variance of the mean of n numbers is 1 / n of theirs; its relative error is a fifth with
    /// 60 draws, a twentieth with 20 times 60.
    #[test]
    fn of_white_noise() {
        let still = Piece { values: vec![3.0; 4000], ..noise(0) };
        let wanted = 1.0 / 4000.0;
        let found = (1..=20).map(|seed| of_levels(&noise(seed), &still, seed)).sum::<f64>() / 20.0;
        assert!((found / wanted - 1.0).abs() < 0.15, "{found} for {wanted}");
        assert_eq!(of_levels(&noise(1), &noise(1), 7), 0.0);
    }

    /// A record shorter than a block has no bootstrap variance.
    #[test]
    fn of_a_short_record() {
        let short = Piece { values: vec![1.0; 150], ..noise(0) };
        assert_eq!(of_levels(&short, &short, 1), 0.0);
    }

    /// A slow periodic motion has a second peak of its correlation after one period, 20 m; noise
    /// has only one.
    #[test]
    fn a_sway_has_no_lag() {
        let layout = Layout {
            channels: Vec::new(),
            edges: vec![0.5, 8.0],
            alike: (0.5, 8.0),
            furthest: 50.0,
        };
        let sway = Piece {
            values: (0..4000)
                .map(|n| (std::f64::consts::TAU * f64::from(n) / 200.0).sin())
                .collect(),
            ..noise(0)
        };
        let has_lag =
            |piece: &Piece| scatter(&layout, piece, piece, &Spectrum::new(piece), 1).has_lag;
        assert!(!has_lag(&sway) && has_lag(&noise(4)));
    }
}
