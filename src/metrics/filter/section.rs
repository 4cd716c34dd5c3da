//! One second-order section of a filter.

/// `(1 + b1 z^-1 + b2 z^-2) / (1 + a1 z^-1 + a2 z^-2)`; the gain is stored once for all sections.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    pub b1: f64,
    pub b2: f64,
    pub a1: f64,
    pub a2: f64,
}

/// Relative error of a gain by rounding beyond which a filter is refused: far below what a record
/// is known to.
const LARGEST_ERROR: f64 = 1e-4;

/// The steady state of a section for a constant input of 1, and its output.
#[derive(Clone, Copy, Debug)]
pub struct Steady {
    pub state: [f64; 2],
    pub output: f64,
}

impl Section {
    pub fn steady(&self) -> Steady {
        let output = (1.0 + self.b1 + self.b2) / (1.0 + self.a1 + self.a2);
        Steady { state: [output - 1.0, self.b2 - self.a2 * output], output }
    }

    /// Amplitude ratio at an angle in rad per sample.
    pub fn magnitude(&self, angle: f64) -> f64 {
        let (sine, cosine) = angle.sin_cos();
        let (sine_2, cosine_2) = (2.0 * angle).sin_cos();
        let along =
            |c1: f64, c2: f64| (1.0 + c1 * cosine + c2 * cosine_2).hypot(c1 * sine + c2 * sine_2);
        along(self.b1, self.b2) / along(self.a1, self.a2)
    }

    /// Whether both poles are inside the unit circle (Jury criterion), and far enough from it: near
    /// it, `1 + a1 + a2` is the difference of nearly equal numbers, and the gain has its relative
    /// rounding error.
    pub fn is_stable(&self) -> bool {
        const LEAST: f64 = f64::EPSILON / LARGEST_ERROR;
        self.a2.abs() < 1.0 && 1.0 + self.a1 + self.a2 > LEAST && 1.0 - self.a1 + self.a2 > 0.0
    }
}
