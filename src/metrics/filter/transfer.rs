//! A filter given by poles and zeros: the bilinear transformation of an analogue transfer function.
//!
//! Frequency weightings of vibration (ISO 2631-1, EN 12299, ISO 8041) are products of such
//! functions.

use std::f64::consts::PI;

use realfft::num_complex::Complex;

use super::{DesignError, butterworth::Design, poles::Poles, section::Section};

/// Roots of a polynomial in s, given by frequencies in Hz.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Roots {
    /// 1 + s/w, w = 2 pi frequency.
    One(f64),
    /// 1 + s/(quality w) + (s/w)^2; for infinite quality, 1 + (s/w)^2.
    Two { frequency: f64, quality: f64 },
}

/// gain x zeros(s) / poles(s), which tends to the gain at low frequencies. Zeros at 0 Hz are s/w or
/// (s/w)^2 with the w of the poles; with as many zeros as poles, the function then tends to the
/// gain at high frequencies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransferFunction {
    pub poles: Roots,
    /// Not more zeros than poles.
    pub zeros: Option<Roots>,
    pub gain: f64,
}

/// Frequencies of the poles and zeros after the bilinear transformation, which compresses all
/// frequencies below half the sampling rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Warping {
    /// As stated; each frequency is pre-warped.
    PreWarped,
    /// Too low; the error increases towards half the sampling rate.
    Plain,
}

impl Roots {
    pub fn frequency(self) -> f64 {
        match self {
            Self::One(frequency) | Self::Two { frequency, .. } => frequency,
        }
    }

    fn count(self) -> i32 {
        if matches!(self, Self::One(_)) { 1 } else { 2 }
    }

    /// The poles in the plane in which z = (1 + s)/(1 - s), with a frequency placed at `at` on its
    /// axis.
    fn placed(self, at: f64) -> Poles {
        match self {
            Self::One(_) => Poles::Single(-at),
            Self::Two { quality, .. } => {
                let half = 0.5 / quality;
                let square = 1.0 - half * half;
                if square >= 0.0 {
                    Poles::Conjugate(Complex::new(-at * half, at * square.sqrt()))
                } else {
                    // The smaller root follows from the product; the difference loses digits.
                    let large = half + (-square).sqrt();
                    Poles::Real(-at * large, -at / large)
                }
            }
        }
    }
}

/// One pass of a filter by poles and zeros.
pub fn design(
    function: &TransferFunction,
    sampling_rate: f64,
    warping: Warping,
) -> Result<Design, DesignError> {
    if !(sampling_rate.is_finite() && sampling_rate > 0.0) {
        return Err(DesignError::SamplingRate { sampling_rate });
    }
    let TransferFunction { poles, zeros, gain } = *function;
    let place = |frequency: f64| match warping {
        Warping::PreWarped if frequency >= sampling_rate / 2.0 => {
            Err(DesignError::Frequency { frequency, sampling_rate })
        }
        Warping::PreWarped => Ok((PI * frequency / sampling_rate).tan()),
        Warping::Plain => Ok(PI * frequency / sampling_rate),
    };
    let degenerate = DesignError::Degenerate { order: poles.count() as usize, sampling_rate };
    if poles.frequency() <= 0.0 || zeros.is_some_and(|zeros| zeros.count() > poles.count()) {
        return Err(degenerate);
    }
    let at = place(poles.frequency())?;
    let placed = poles.placed(at);
    let (a1, a2) = placed.denominator();
    // (s - p)/(-p) for each root p is (1 - p)/(-p) times (1 - z_p/z)/(1 + 1/z).
    let mut of_gain = gain * at.powi(poles.count()) / placed.product();
    let (mut b1, mut b2) = (0.0, 0.0);
    if let Some(zeros) = zeros {
        let at_zeros = place(zeros.frequency())?;
        let placed = zeros.placed(at_zeros);
        (b1, b2) = placed.denominator();
        let scale = if zeros.frequency() == 0.0 { at } else { at_zeros };
        of_gain *= placed.product() / scale.powi(zeros.count());
    }
    // Poles in excess of the zeros have zeros at infinity, which the transformation moves to z =
    // -1.
    for _ in 0..poles.count() - zeros.map_or(0, Roots::count) {
        (b1, b2) = (b1 + 1.0, b2 + b1);
    }
    let section = Section { b1, b2, a1, a2 };
    let time_constant = placed.time_constant();
    if of_gain > 0.0 && of_gain.is_finite() && time_constant.is_finite() && section.is_stable() {
        Ok(Design { gain: of_gain, sections: vec![section], time_constant })
    } else {
        Err(degenerate)
    }
}
