//! Butterworth design: analogue prototype, frequency transformation, bilinear transformation, pairing into sections.
//!
//! The variable of the analogue plane is scaled so that the bilinear transformation is z = (1 + s) / (1 - s), and a
//! frequency f stands at tan(pi f / sampling rate).

use std::f64::consts::PI;

use super::{Band, DesignError, section::Section};

pub(super) const HIGHEST_ORDER: usize = 20;

pub(super) struct Design {
    pub gain: f64,
    pub sections: Vec<Section>,
    /// Of the slowest pole, in samples.
    pub time_constant: f64,
}

/// Where the response is to go: the pre-warped edges, moved if both passes together are to have their -3 dB there.
#[derive(Clone, Copy)]
enum Target {
    LowPass { edge: f64 },
    HighPass { edge: f64 },
    BandPass { width: f64, centre: f64 },
    BandStop { width: f64, centre: f64 },
}

pub(super) fn design(band: Band, order: usize, sampling_rate: f64, both_passes: bool) -> Result<Design, DesignError> {
    if !(1..=HIGHEST_ORDER).contains(&order) {
        return Err(DesignError::Order { order });
    }
    let target = target(band, order, sampling_rate, both_passes)?;
    let (gain, mut poles) = poles(target, order);
    // SciPy's order: the poles nearest to the unit circle last, so that what they amplify has been attenuated before.
    poles.sort_by(|left, right| left.radius().total_cmp(&right.radius()));
    let sections: Vec<Section> = sections(target, order, &poles);
    let time_constant = poles.iter().map(Poles::time_constant).fold(0.0, f64::max);
    if gain > 0.0 && time_constant.is_finite() && sections.iter().all(Section::is_stable) {
        Ok(Design { gain, sections, time_constant })
    } else {
        Err(DesignError::Degenerate { order, sampling_rate })
    }
}

fn target(band: Band, order: usize, sampling_rate: f64, both_passes: bool) -> Result<Target, DesignError> {
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
        if low < high && warped_low < warped_high { Ok((warped_low, warped_high)) } else { Err(DesignError::Edges { low, high }) }
    };
    // Two passes are at 1/sqrt(2) where one is at 2^(-1/4), that is where (w / edge)^(2 order) = sqrt(2) - 1.
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

/// The poles of one section in the analogue plane.
#[derive(Clone, Copy)]
enum Poles {
    /// `re ± i im`
    Conjugate(Complex),
    Real(f64, f64),
    Single(f64),
}

impl Poles {
    /// Denominator `a1`, `a2` of the section.
    fn denominator(&self) -> (f64, f64) {
        match *self {
            Self::Conjugate(s) => {
                let below = s.distance_to_one();
                (-2.0 * (1.0 - s.square()) / below, Complex { re: -s.re, im: s.im }.distance_to_one() / below)
            }
            Self::Real(one, two) => {
                let (one, two) = (bilinear(one), bilinear(two));
                (-(one + two), one * two)
            }
            Self::Single(s) => (-bilinear(s), 0.0),
        }
    }

    /// Product of `1 - s`: what the bilinear transformation takes out of the gain.
    fn product(&self) -> f64 {
        match *self {
            Self::Conjugate(s) => s.distance_to_one(),
            Self::Real(one, two) => (1.0 - one) * (1.0 - two),
            Self::Single(s) => 1.0 - s,
        }
    }

    /// The digital pole nearest to the unit circle: real part and distance from the origin.
    fn outer(&self) -> (f64, f64) {
        match *self {
            Self::Conjugate(_) => {
                let (a1, a2) = self.denominator();
                (-a1 / 2.0, a2.sqrt())
            }
            Self::Real(one, two) => {
                let (one, two) = (bilinear(one), bilinear(two));
                let outer = if one.abs() > two.abs() { one } else { two };
                (outer, outer.abs())
            }
            Self::Single(s) => (bilinear(s), bilinear(s).abs()),
        }
    }

    fn radius(&self) -> f64 {
        self.outer().1
    }

    /// Samples until the slowest of the poles has fallen to 1/e: -1 / ln |z|, without the cancellation near |z| = 1.
    fn time_constant(&self) -> f64 {
        let samples = |s: Complex| -2.0 / (4.0 * s.re / s.distance_to_one()).ln_1p();
        let real = |s: f64| samples(Complex { re: s, im: 0.0 });
        match *self {
            Self::Conjugate(s) => samples(s),
            Self::Real(one, two) => real(one).max(real(two)),
            // A real pole at the origin has no memory: ln 0.
            Self::Single(s) => real(s),
        }
    }
}

/// Gain of one pass and the poles, two per section.
fn poles(target: Target, order: usize) -> (f64, Vec<Poles>) {
    let mut gain = 1.0;
    let mut all = Vec::with_capacity(order + 1);
    let mut place = |poles: Poles, numerator: f64| {
        gain *= numerator / poles.product();
        all.push(poles);
    };
    // Prototype poles exp(i angle) in the upper half plane; their conjugates come with them.
    for k in 0..order / 2 {
        let (sine, cosine) = (PI * (2 * k + 1) as f64 / (2 * order) as f64).sin_cos();
        let pole = Complex { re: -sine, im: cosine };
        // The pole lies on the unit circle: its inverse is its conjugate.
        let inverse = Complex { re: pole.re, im: -pole.im };
        match target {
            Target::LowPass { edge } => place(Poles::Conjugate(pole.times(edge)), edge * edge),
            Target::HighPass { edge } => place(Poles::Conjugate(inverse.times(edge)), 1.0),
            Target::BandPass { width, centre } => {
                for s in around(pole.times(width / 2.0), centre) {
                    place(Poles::Conjugate(s), width);
                }
            }
            Target::BandStop { width, centre } => {
                for s in around(inverse.times(width / 2.0), centre) {
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
            Target::BandStop { width, centre } => place(around_real(width, centre), 1.0 + centre * centre),
        }
    }
    (gain, all)
}

/// Roots of s^2 - 2 half s + centre^2: where the transformation to a band moves a pole. The smaller root from the product,
/// as the difference would cancel in a wide band.
fn around(half: Complex, centre: f64) -> [Complex; 2] {
    let square = Complex { re: half.re * half.re - half.im * half.im - centre * centre, im: 2.0 * half.re * half.im };
    let root = square.sqrt();
    let (plus, minus) =
        (Complex { re: half.re + root.re, im: half.im + root.im }, Complex { re: half.re - root.re, im: half.im - root.im });
    let large = if plus.square() > minus.square() { plus } else { minus };
    let scale = centre * centre / large.square();
    [large, Complex { re: large.re * scale, im: -large.im * scale }]
}

/// The same for the real prototype pole -1.
fn around_real(width: f64, centre: f64) -> Poles {
    let half = -width / 2.0;
    let square = half * half - centre * centre;
    if square < 0.0 {
        Poles::Conjugate(Complex { re: half, im: (-square).sqrt() })
    } else {
        let large = half - square.sqrt();
        Poles::Real(large, centre * centre / large)
    }
}

/// Zeros to poles: the poles nearest to the unit circle take the nearest zeros first.
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
                (Target::BandStop { centre, .. }, _) => (-2.0 * (1.0 - centre * centre) / (1.0 + centre * centre), 1.0),
                (Target::BandPass { .. }, _) => {
                    let mut nearest = || {
                        let at_plus_one = left_at_minus_one == 0 || (left_at_plus_one > 0 && poles.outer().0 > 0.0);
                        let left = if at_plus_one { &mut left_at_plus_one } else { &mut left_at_minus_one };
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

fn bilinear(s: f64) -> f64 {
    (1.0 + s) / (1.0 - s)
}

#[derive(Clone, Copy)]
struct Complex {
    re: f64,
    im: f64,
}

impl Complex {
    fn times(self, factor: f64) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }

    fn square(self) -> f64 {
        self.re * self.re + self.im * self.im
    }

    /// |1 - s|^2
    fn distance_to_one(self) -> f64 {
        (1.0 - self.re) * (1.0 - self.re) + self.im * self.im
    }

    /// Principal square root, without cancellation in either part.
    fn sqrt(self) -> Self {
        let larger = ((self.re.hypot(self.im) + self.re.abs()) / 2.0).sqrt();
        if larger == 0.0 {
            return Self { re: 0.0, im: 0.0 };
        }
        let smaller = self.im.abs() / (2.0 * larger);
        let (re, im) = if self.re >= 0.0 { (larger, smaller) } else { (smaller, larger) };
        Self { re, im: im.copysign(self.im) }
    }
}
