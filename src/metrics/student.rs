//! Quantiles of Student's t.

use statrs::distribution::{Continuous, ContinuousCDF, StudentsT};

use super::incomplete_beta::incomplete_beta;

/// A tail this close to the one asked for, relative to it, is met: what is left is rounding of the tail.
const CLOSE: f64 = 1e-11;

/// Of these a handful is needed; it ends in any case.
const MOST_STEPS: usize = 50;

/// The value that Student's t with `degrees` degrees of freedom stays below with this probability. Degrees need not be whole.
///
/// `None`: a probability not between 0 and 1, degrees that are not positive and finite.
///
/// The library's is off in the sixth digit from some 10,000 degrees of freedom on, and far out with few: Newton's steps on a tail
/// that is not. The smaller tail is worked on, so that a probability near 0 keeps its digits.
pub fn student_quantile(probability: f64, degrees: f64) -> Option<f64> {
    if !(probability > 0.0 && probability < 1.0 && degrees.is_finite()) {
        return None;
    }
    let student = StudentsT::new(0.0, 1.0, degrees).ok()?;
    let tail = probability.min(1.0 - probability);
    let mut t = student.inverse_cdf(tail).abs();
    let beyond = |t: f64| {
        let square = t * t;
        0.5 * incomplete_beta(degrees / 2.0, 0.5, degrees / (degrees + square), square / (degrees + square))
    };
    for _ in 0..3 {
        let step = (beyond(t) - tail) / student.pdf(t);
        if !step.is_finite() {
            break;
        }
        t += step;
    }
    // Far out the tail is a power of t: a straight line between the logarithms, where Newton's steps are long enough.
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
