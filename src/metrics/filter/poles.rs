//! Roots in the analogue plane, and their images under the bilinear transformation.

use realfft::num_complex::Complex;

/// The poles of one section in the analogue plane.
#[derive(Clone, Copy)]
pub enum Poles {
    /// `re ± i im`
    Conjugate(Complex<f64>),
    Real(f64, f64),
    Single(f64),
}

impl Poles {
    /// Denominator `a1`, `a2` of the section.
    pub fn denominator(&self) -> (f64, f64) {
        match *self {
            Self::Conjugate(s) => {
                let below = distance_to_one(s);
                (-2.0 * (1.0 - s.norm_sqr()) / below, distance_to_one(-s.conj()) / below)
            }
            Self::Real(one, two) => {
                let (one, two) = (bilinear(one), bilinear(two));
                (-(one + two), one * two)
            }
            Self::Single(s) => (-bilinear(s), 0.0),
        }
    }

    /// Product of `1 - s`: the factor of the gain from the bilinear transformation.
    pub fn product(&self) -> f64 {
        match *self {
            Self::Conjugate(s) => distance_to_one(s),
            Self::Real(one, two) => (1.0 - one) * (1.0 - two),
            Self::Single(s) => 1.0 - s,
        }
    }

    /// The digital pole nearest to the unit circle: real part and distance from the origin.
    pub fn outer(&self) -> (f64, f64) {
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

    pub fn radius(&self) -> f64 {
        self.outer().1
    }

    /// Number of samples in which the slowest pole decays to 1/e: -1 / ln |z|, without loss of
    /// digits near |z| = 1.
    pub fn time_constant(&self) -> f64 {
        let samples = |s: Complex<f64>| -2.0 / (4.0 * s.re / distance_to_one(s)).ln_1p();
        let real = |s: f64| samples(s.into());
        match *self {
            Self::Conjugate(s) => samples(s),
            Self::Real(one, two) => real(one).max(real(two)),
            // A real pole at the origin has no memory (ln 0).
            Self::Single(s) => real(s),
        }
    }
}

fn bilinear(s: f64) -> f64 {
    (1.0 + s) / (1.0 - s)
}

/// |1 - s|^2
fn distance_to_one(s: Complex<f64>) -> f64 {
    (1.0 - s.re) * (1.0 - s.re) + s.im * s.im
}

/// Principal square root, without loss of digits in either part.
pub fn root(s: Complex<f64>) -> Complex<f64> {
    let larger = ((s.re.hypot(s.im) + s.re.abs()) / 2.0).sqrt();
    if larger == 0.0 {
        return Complex::default();
    }
    let smaller = s.im.abs() / (2.0 * larger);
    let (re, im) = if s.re >= 0.0 { (larger, smaller) } else { (smaller, larger) };
    Complex::new(re, im.copysign(s.im))
}
