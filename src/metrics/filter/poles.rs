//! Roots in the analogue plane, and their images under the bilinear transformation.

/// The poles of one section in the analogue plane.
#[derive(Clone, Copy)]
pub(super) enum Poles {
    /// `re ± i im`
    Conjugate(Complex),
    Real(f64, f64),
    Single(f64),
}

impl Poles {
    /// Denominator `a1`, `a2` of the section.
    pub(super) fn denominator(&self) -> (f64, f64) {
        match *self {
            Self::Conjugate(s) => {
                let below = s.distance_to_one();
                (
                    -2.0 * (1.0 - s.square()) / below,
                    Complex { re: -s.re, im: s.im }.distance_to_one() / below,
                )
            }
            Self::Real(one, two) => {
                let (one, two) = (bilinear(one), bilinear(two));
                (-(one + two), one * two)
            }
            Self::Single(s) => (-bilinear(s), 0.0),
        }
    }

    /// Product of `1 - s`: the factor of the gain from the bilinear transformation.
    pub(super) fn product(&self) -> f64 {
        match *self {
            Self::Conjugate(s) => s.distance_to_one(),
            Self::Real(one, two) => (1.0 - one) * (1.0 - two),
            Self::Single(s) => 1.0 - s,
        }
    }

    /// The digital pole nearest to the unit circle: real part and distance from the origin.
    pub(super) fn outer(&self) -> (f64, f64) {
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

    pub(super) fn radius(&self) -> f64 {
        self.outer().1
    }

    /// Number of samples in which the slowest pole decays to 1/e: -1 / ln |z|, without loss of
    /// digits near |z| = 1.
    pub(super) fn time_constant(&self) -> f64 {
        let samples = |s: Complex| -2.0 / (4.0 * s.re / s.distance_to_one()).ln_1p();
        let real = |s: f64| samples(Complex { re: s, im: 0.0 });
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

#[derive(Clone, Copy)]
pub(super) struct Complex {
    pub(super) re: f64,
    pub(super) im: f64,
}

impl Complex {
    pub(super) fn times(self, factor: f64) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }

    pub(super) fn square(self) -> f64 {
        self.re * self.re + self.im * self.im
    }

    /// |1 - s|^2
    pub(super) fn distance_to_one(self) -> f64 {
        (1.0 - self.re) * (1.0 - self.re) + self.im * self.im
    }

    /// Principal square root, without loss of digits in either part.
    pub(super) fn sqrt(self) -> Self {
        let larger = ((self.re.hypot(self.im) + self.re.abs()) / 2.0).sqrt();
        if larger == 0.0 {
            return Self { re: 0.0, im: 0.0 };
        }
        let smaller = self.im.abs() / (2.0 * larger);
        let (re, im) = if self.re >= 0.0 { (larger, smaller) } else { (smaller, larger) };
        Self { re, im: im.copysign(self.im) }
    }
}
