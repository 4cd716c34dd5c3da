//! Exponents of the base dimensions.

use std::fmt;
use std::ops::{Div, Mul};

/// Exponents of length, mass, time, temperature, electric current, and temperature in degrees
/// Celsius. An angle is dimensionless.
///
/// Degrees Celsius count from another zero than kelvin. As a dimension of their own they cannot be
/// mixed with kelvin by mistake, and a difference of two is right without an offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct Dimension(pub [i8; 6]);

const BASE: [&str; 6] = ["m", "kg", "s", "K", "A", "degC"];

/// Dimensions with a name.
const WORDS: [(Dimension, &str); 31] = [
    (Dimension::ONE, "a plain number"),
    (Dimension([1, 0, 0, 0, 0, 0]), "a length"),
    (Dimension([2, 0, 0, 0, 0, 0]), "an area"),
    (Dimension([-1, 0, 0, 0, 0, 0]), "a curvature"),
    (Dimension([0, 1, 0, 0, 0, 0]), "a mass"),
    (Dimension([0, 0, 1, 0, 0, 0]), "a time"),
    (Dimension([0, 0, -1, 0, 0, 0]), "a frequency"),
    (Dimension([1, 0, -1, 0, 0, 0]), "a speed"),
    (Dimension([1, 0, -2, 0, 0, 0]), "an acceleration"),
    (Dimension([1, 0, -3, 0, 0, 0]), "a jerk"),
    (Dimension([1, 1, -2, 0, 0, 0]), "a force"),
    (Dimension([2, 1, -2, 0, 0, 0]), "a moment or an energy"),
    (Dimension([2, 1, -3, 0, 0, 0]), "a power"),
    (Dimension([-1, 1, -2, 0, 0, 0]), "a pressure"),
    (Dimension([0, 1, -2, 0, 0, 0]), "a stiffness"),
    (Dimension([0, 1, -1, 0, 0, 0]), "a damping constant"),
    (Dimension([2, 1, 0, 0, 0, 0]), "a moment of inertia"),
    (Dimension([0, 0, 0, 1, 0, 0]), "a temperature"),
    (Dimension([0, 0, 0, 0, 1, 0]), "an electric current"),
    (Dimension([2, 1, -3, 0, -1, 0]), "a voltage"),
    (Dimension([0, 0, 0, 0, 0, 1]), "a temperature in degrees Celsius"),
    (Dimension([3, 0, 0, 0, 0, 0]), "a volume"),
    (Dimension([2, 1, -3, 0, -2, 0]), "an electric resistance"),
    (Dimension([-2, -1, 3, 0, 2, 0]), "an electric conductance"),
    (Dimension([0, 0, 1, 0, 1, 0]), "an electric charge"),
    (Dimension([-2, -1, 4, 0, 2, 0]), "a capacitance"),
    (Dimension([2, 1, -2, 0, -2, 0]), "an inductance"),
    (Dimension([2, 1, -2, 0, -1, 0]), "a magnetic flux"),
    (Dimension([0, 1, -2, 0, -1, 0]), "a magnetic flux density"),
    (Dimension([0, 0, -2, 0, 0, 0]), "an angular acceleration"),
    (Dimension([2, 1, -1, 0, 0, 0]), "a rotational damping constant"),
];

impl Dimension {
    pub const ONE: Self = Self([0; 6]);
    pub const LENGTH: Self = Self([1, 0, 0, 0, 0, 0]);
    pub const TIME: Self = Self([0, 0, 1, 0, 0, 0]);
    pub const FREQUENCY: Self = Self([0, 0, -1, 0, 0, 0]);
    pub const SPEED: Self = Self([1, 0, -1, 0, 0, 0]);
    pub const ACCELERATION: Self = Self([1, 0, -2, 0, 0, 0]);
    pub const FORCE: Self = Self([1, 1, -2, 0, 0, 0]);

    /// `self` to an integer power; `None` if an exponent exceeds the range.
    pub fn power(self, exponent: i8) -> Option<Self> {
        let mut out = [0; 6];
        for (to, from) in out.iter_mut().zip(self.0) {
            *to = from.checked_mul(exponent)?;
        }
        Some(Self(out))
    }

    /// The square root, if all exponents are even.
    pub fn root(self) -> Option<Self> {
        self.0
            .iter()
            .all(|exponent| exponent % 2 == 0)
            .then(|| Self(self.0.map(|exponent| exponent / 2)))
    }

    /// "a force", "an acceleration", or the base units.
    pub fn in_words(self) -> String {
        WORDS
            .iter()
            .find(|(dimension, _)| *dimension == self)
            .map_or_else(|| format!("a quantity in {self}"), |(_, word)| (*word).to_string())
    }
}

impl Mul for Dimension {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self(std::array::from_fn(|at| self.0[at].saturating_add(other.0[at])))
    }
}

impl Div for Dimension {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        Self(std::array::from_fn(|at| self.0[at].saturating_sub(other.0[at])))
    }
}

/// SI base units, for instance `kg m s^-2`.
impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts: Vec<String> = BASE
            .iter()
            .zip(self.0)
            .filter(|(_, exponent)| *exponent != 0)
            .map(
                |(name, exponent)| {
                    if exponent == 1 { (*name).to_string() } else { format!("{name}^{exponent}") }
                },
            )
            .collect();
        f.write_str(if parts.is_empty() { "-".to_string() } else { parts.join(" ") }.as_str())
    }
}
