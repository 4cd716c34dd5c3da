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

/// Dimensions with a name, in base units.
const WORDS: [(&str, &str); 31] = [
    ("-", "a plain number"),
    ("m", "a length"),
    ("m^2", "an area"),
    ("m^-1", "a curvature"),
    ("kg", "a mass"),
    ("s", "a time"),
    ("s^-1", "a frequency"),
    ("m s^-1", "a speed"),
    ("m s^-2", "an acceleration"),
    ("m s^-3", "a jerk"),
    ("m kg s^-2", "a force"),
    ("m^2 kg s^-2", "a moment or an energy"),
    ("m^2 kg s^-3", "a power"),
    ("m^-1 kg s^-2", "a pressure"),
    ("kg s^-2", "a stiffness"),
    ("kg s^-1", "a damping constant"),
    ("m^2 kg", "a moment of inertia"),
    ("K", "a temperature"),
    ("A", "an electric current"),
    ("m^2 kg s^-3 A^-1", "a voltage"),
    ("degC", "a temperature in degrees Celsius"),
    ("m^3", "a volume"),
    ("m^2 kg s^-3 A^-2", "an electric resistance"),
    ("m^-2 kg^-1 s^3 A^2", "an electric conductance"),
    ("s A", "an electric charge"),
    ("m^-2 kg^-1 s^4 A^2", "a capacitance"),
    ("m^2 kg s^-2 A^-2", "an inductance"),
    ("m^2 kg s^-2 A^-1", "a magnetic flux"),
    ("kg s^-2 A^-1", "a magnetic flux density"),
    ("s^-2", "an angular acceleration"),
    ("m^2 kg s^-1", "a rotational damping constant"),
];

impl Dimension {
    pub const ONE: Self = Self([0; 6]);
    pub const LENGTH: Self = Self([1, 0, 0, 0, 0, 0]);
    pub const TIME: Self = Self([0, 0, 1, 0, 0, 0]);
    pub const FREQUENCY: Self = Self([0, 0, -1, 0, 0, 0]);
    /// Of a frequency in cycles per length.
    pub const PER_LENGTH: Self = Self([-1, 0, 0, 0, 0, 0]);
    pub const SPEED: Self = Self([1, 0, -1, 0, 0, 0]);
    pub const ACCELERATION: Self = Self([1, 0, -2, 0, 0, 0]);
    pub const FORCE: Self = Self([1, 1, -2, 0, 0, 0]);

    /// The dimension of a product of base units, as it is printed: `kg m s^-2`.
    pub(super) fn in_base_units(text: &str) -> Self {
        let mut exponents = [0; 6];
        for unit in text.split(' ') {
            let (base, exponent) = unit.split_once('^').unwrap_or((unit, "1"));
            let at = BASE.iter().position(|known| *known == base);
            if let (Some(at), Ok(exponent)) = (at, exponent.parse()) {
                exponents[at] = exponent;
            }
        }
        Self(exponents)
    }

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
        let units = self.to_string();
        let named = WORDS.iter().find(|(dimension, _)| *dimension == units);
        named.map_or_else(|| format!("a quantity in {units}"), |(_, word)| (*word).to_string())
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
