//! Butterworth design: analogue prototype, frequency transformation, bilinear transformation,
//! pairing into sections.
//!
//! The variable of the analogue plane is scaled so that the bilinear transformation is z = (1 + s)
//! / (1 - s), and a frequency f is at tan(pi f / sampling rate).

use std::f64::consts::PI;

use realfft::num_complex::Complex;

use super::{
    Band, DesignError,
    poles::{Poles, root},
    section::Section,
};

pub const HIGHEST_ORDER: usize = 20;

pub struct Design {
    pub gain: f64,
    pub sections: Vec<Section>,
    /// Of the slowest pole, in samples.
    pub time_constant: f64,
}

/// Edges of the response after pre-warping, moved if both passes together are to have their -3 dB
/// points there.
#[derive(Clone, Copy)]
enum Target {
    LowPass { edge: f64 },
    HighPass { edge: f64 },
    BandPass { width: f64, centre: f64 },
    BandStop { width: f64, centre: f64 },
}

/// One pass of a Butterworth filter.
pub fn design(
    band: Band,
    order: usize,
    sampling_rate: f64,
    both_passes: bool,
) -> Result<Design, DesignError> {
    if !(1..=HIGHEST_ORDER).contains(&order) {
        return Err(DesignError::Order { order });
    }
    let target = target(band, order, sampling_rate, both_passes)?;
    let (gain, mut poles) = poles(target, order);
    // Order of SciPy: poles nearest to the unit circle last, so that the signal they amplify was
    // attenuated before.
    poles.sort_by(|left, right| left.radius().total_cmp(&right.radius()));
    let sections: Vec<Section> = sections(target, order, &poles);
    let time_constant = poles.iter().map(Poles::time_constant).fold(0.0, f64::max);
    if gain > 0.0 && time_constant.is_finite() && sections.iter().all(Section::is_stable) {
        Ok(Design { gain, sections, time_constant })
    } else {
        Err(DesignError::Degenerate { order, sampling_rate })
    }
}

fn target(
    band: Band,
    order: usize,
    sampling_rate: f64,
    both_passes: bool,
) -> Result<Target, DesignError> {
    if !(sampling_rate.is_finite() && sampling_rate > 0.0) {
        return Err(DesignError::SamplingRate { sampling_rate });
    }
    let warped = |frequency: f64| {
        if frequency > 0.0 && frequency < sampling_rate / 2.0 {
            Ok((PI * frequency / sampling_rate).tan())
        } else {
            Err(DesignError::Frequency { frequency, sampling_rate })
        }
    };
    let edges = |low: f64, high: f64| {
        let (warped_low, warped_high) = (warped(low)?, warped(high)?);
        if low < high && warped_low < warped_high {
            Ok((warped_low, warped_high))
        } else {
            Err(DesignError::Edges { low, high })
        }
    };
    // Two passes have a gain of 1/sqrt(2) where one has 2^(-1/4), that is where (w / edge)^(2
    // order) = sqrt(2) - 1.
    let widen = if both_passes { (2_f64.sqrt() - 1.0).powf(-0.5 / order as f64) } else { 1.0 };
    Ok(match band {
        Band::LowPass(frequency) => Target::LowPass { edge: warped(frequency)? * widen },
        Band::HighPass(frequency) => Target::HighPass { edge: warped(frequency)? / widen },
        Band::BandPass(low, high) => {
            let (low, high) = edges(low, high)?;
            Target::BandPass { width: (high - low) * widen, centre: (low * high).sqrt() }
        }
        Band::BandStop(low, high) => {
            let (low, high) = edges(low, high)?;
            Target::BandStop { width: (high - low) / widen, centre: (low * high).sqrt() }
        }
    })
}

/// Gain of one pass and the poles, two per section.
fn poles(target: Target, order: usize) -> (f64, Vec<Poles>) {
    let mut gain = 1.0;
    let mut all = Vec::with_capacity(order + 1);
    let mut place = |poles: Poles, numerator: f64| {
        gain *= numerator / poles.product();
        all.push(poles);
    };
    // Prototype poles exp(i angle) in the upper half plane; each stands for itself and its
    // conjugate.
    for k in 0..order / 2 {
        let (sine, cosine) = (PI * (2 * k + 1) as f64 / (2 * order) as f64).sin_cos();
        let pole = Complex::new(-sine, cosine);
        // The pole is on the unit circle: its inverse is its conjugate.
        let inverse = pole.conj();
        match target {
            Target::LowPass { edge } => place(Poles::Conjugate(pole * edge), edge * edge),
            Target::HighPass { edge } => place(Poles::Conjugate(inverse * edge), 1.0),
            Target::BandPass { width, centre } => {
                for s in around(pole * (width / 2.0), centre) {
                    place(Poles::Conjugate(s), width);
                }
            }
            Target::BandStop { width, centre } => {
                for s in around(inverse * (width / 2.0), centre) {
                    place(Poles::Conjugate(s), 1.0 + centre * centre);
                }
            }
        }
    }
    if order % 2 == 1 {
        match target {
            Target::LowPass { edge } => place(Poles::Single(-edge), edge),
            Target::HighPass { edge } => place(Poles::Single(-edge), 1.0),
            Target::BandPass { width, centre } => place(around_real(width, centre), width),
            Target::BandStop { width, centre } => {
                place(around_real(width, centre), 1.0 + centre * centre)
            }
        }
    }
    (gain, all)
}

/// Roots of s^2 - 2 half s + centre^2: the poles that the band transformation makes of a pole. The
/// smaller root follows from the product, as the difference loses digits in a wide band.
fn around(half: Complex<f64>, centre: f64) -> [Complex<f64>; 2] {
    let root = root(half * half - centre * centre);
    let (plus, minus) = (half + root, half - root);
    let large = if plus.norm_sqr() > minus.norm_sqr() { plus } else { minus };
    [large, large.conj() * (centre * centre / large.norm_sqr())]
}

/// The same for the real prototype pole -1.
fn around_real(width: f64, centre: f64) -> Poles {
    let half = -width / 2.0;
    let square = half * half - centre * centre;
    if square < 0.0 {
        Poles::Conjugate(Complex::new(half, (-square).sqrt()))
    } else {
        let large = half - square.sqrt();
        Poles::Real(large, centre * centre / large)
    }
}

/// Assigns zeros to poles; the poles nearest to the unit circle get the nearest zeros first.
fn sections(target: Target, order: usize, poles: &[Poles]) -> Vec<Section> {
    let (mut left_at_plus_one, mut left_at_minus_one) = (order, order);
    let mut sections: Vec<Section> = poles
        .iter()
        .rev()
        .map(|poles| {
            let (a1, a2) = poles.denominator();
            let (b1, b2) = match (target, poles) {
                (Target::LowPass { .. }, Poles::Single(_)) => (1.0, 0.0),
                (Target::LowPass { .. }, _) => (2.0, 1.0),
                (Target::HighPass { .. }, Poles::Single(_)) => (-1.0, 0.0),
                (Target::HighPass { .. }, _) => (-2.0, 1.0),
                (Target::BandStop { centre, .. }, _) => {
                    (-2.0 * (1.0 - centre * centre) / (1.0 + centre * centre), 1.0)
                }
                (Target::BandPass { .. }, _) => {
                    let mut nearest = || {
                        let at_plus_one = left_at_minus_one == 0
                            || (left_at_plus_one > 0 && poles.outer().0 > 0.0);
                        let left = if at_plus_one {
                            &mut left_at_plus_one
                        } else {
                            &mut left_at_minus_one
                        };
                        *left -= 1;
                        if at_plus_one { 1.0 } else { -1.0 }
                    };
                    let (one, two) = (nearest(), nearest());
                    (-(one + two), one * two)
                }
            };
            Section { b1, b2, a1, a2 }
        })
        .collect();
    sections.reverse();
    sections
}
