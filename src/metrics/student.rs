//! Quantiles of Student's t.

use statrs::distribution::{Continuous, ContinuousCDF, StudentsT};

use super::incomplete_beta::incomplete_beta;

/// Relative tolerance of the tail probability; the rest is rounding.
const CLOSE: f64 = 1e-11;

/// Largest number of Newton steps; a few are needed.
const MOST_STEPS: usize = 50;

/// Quantile of Student's t: the value that is not exceeded with this probability, for any positive
/// number of degrees of freedom.
///
/// `None` for a probability not between 0 and 1, or degrees of freedom that are not positive and
/// finite.
///
/// The quantile of the library is wrong in the sixth digit from about 10,000 degrees of freedom on,
/// and far in the tails for few degrees. Its tail probability is accurate; this function applies
/// Newton steps to it. It uses the smaller tail, so that a probability near 0 keeps its digits.
pub fn student_quantile(probability: f64, degrees: f64) -> Option<f64> {
    if !(probability > 0.0 && probability < 1.0 && degrees.is_finite()) {
        return None;
    }
    let student = StudentsT::new(0.0, 1.0, degrees).ok()?;
    let tail = probability.min(1.0 - probability);
    let mut t = student.inverse_cdf(tail).abs();
    let beyond = |t: f64| {
        let square = t * t;
        0.5 * incomplete_beta(
            degrees / 2.0,
            0.5,
            degrees / (degrees + square),
            square / (degrees + square),
        )
    };
    for _ in 0..3 {
        let step = (beyond(t) - tail) / student.pdf(t);
        if !step.is_finite() {
            break;
        }
        t += step;
    }
    // Far out, the tail is a power of t. Newton steps in the logarithms, where it is a straight
    // line, are long enough.
    for _ in 0..MOST_STEPS {
        let left = beyond(t);
        let step = (left / tail).ln() * left / (t * student.pdf(t));
        if (left / tail - 1.0).abs() < CLOSE || !step.is_finite() {
            break;
        }
        t *= step.exp();
    }
    Some(if probability < 0.5 { -t } else { t }).filter(|t| t.is_finite())
}
