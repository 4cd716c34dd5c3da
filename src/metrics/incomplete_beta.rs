//! The regularised incomplete beta function, also for large numbers of degrees of freedom.

use std::f64::consts::TAU;

use statrs::function::gamma::ln_gamma;

/// I_x(a, b) for positive a and b and x in [0, 1]. `complement` is 1 - x, passed separately so that
/// neither loses digits.
///
/// Continued fraction by Lentz's method (Numerical Recipes, 3rd ed., 6.4). It needs of the order of
/// sqrt(max(a, b)) terms; libraries limit the number of terms, which is not sufficient for long
/// records.
pub fn incomplete_beta(a: f64, b: f64, x: f64, complement: f64) -> f64 {
    if x <= 0.0 {
        0.0
    } else if complement <= 0.0 {
        1.0
    } else if x < (a + 1.0) / (a + b + 2.0) {
        ln_front(a, b, x, complement).exp() * fraction(a, b, x) / a
    } else {
        1.0 - ln_front(a, b, x, complement).exp() * fraction(b, a, complement) / b
    }
}

/// ln of x^a (1 - x)^b / B(a, b)
///
/// With Stirling's formula for large arguments, where differences of large logarithms would lose
/// digits.
fn ln_front(a: f64, b: f64, x: f64, complement: f64) -> f64 {
    let (small, large) = (a.min(b), a.max(b));
    if small >= STIRLING {
        // Expanded about the maximum at a / (a + b).
        let off = x * b - complement * a;
        let deviance = a * (off / a).ln_1p() + b * (-off / b).ln_1p();
        return deviance + 0.5 * (a * b / (TAU * (a + b))).ln() + stirling(a + b)
            - stirling(a)
            - stirling(b);
    }
    let ratio = if large >= STIRLING {
        (large - 0.5) * (small / large).ln_1p() + small * (a + b).ln() - small + stirling(a + b)
            - stirling(large)
    } else {
        ln_gamma(a + b) - ln_gamma(large)
    };
    let ln = |part: f64, other: f64| if part > 0.5 { (-other).ln_1p() } else { part.ln() };
    ratio - ln_gamma(small) + a * ln(x, complement) + b * ln(complement, x)
}

/// From this argument on, five terms of Stirling's series are exact in double precision.
const STIRLING: f64 = 20.0;

/// ln Gamma(z) minus Stirling's formula.
fn stirling(z: f64) -> f64 {
    let square = 1.0 / (z * z);
    (1.0 / 12.0
        - square
            * (1.0 / 360.0 - square * (1.0 / 1260.0 - square * (1.0 / 1680.0 - square / 1188.0))))
        / z
}

fn fraction(a: f64, b: f64, x: f64) -> f64 {
    let away_from_zero =
        |value: f64| if value.abs() < f64::MIN_POSITIVE { f64::MIN_POSITIVE } else { value };
    let most_terms = 100 + (10.0 * a.max(b).sqrt()) as usize;
    let mut c = 1.0;
    let mut d = 1.0 / away_from_zero(1.0 - (a + b) * x / (a + 1.0));
    let mut result = d;
    for m in (1..=most_terms).map(|m| m as f64) {
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        d = 1.0 / away_from_zero(1.0 + even * d);
        c = away_from_zero(1.0 + even / c);
        result *= d * c;
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        d = 1.0 / away_from_zero(1.0 + odd * d);
        c = away_from_zero(1.0 + odd / c);
        let change = d * c;
        result *= change;
        if (change - 1.0).abs() <= f64::EPSILON {
            break;
        }
    }
    result
}
