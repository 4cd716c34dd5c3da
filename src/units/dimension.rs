//! Exponents of the base dimensions.

use std::{
    fmt,
    ops::{Div, Mul},
};

/// Exponents of length, mass, time, temperature, electric current, and temperature in degrees
/// Celsius. An angle is dimensionless.
///
/// Exponents are fractions, counted in sixtieths: halves, thirds, quarters, fifths, sixths, tenths
/// and so on are exact.
///
/// Degrees Celsius count from another zero than kelvin. As a dimension of their own they cannot be
/// mixed with kelvin by mistake, and a difference of two is right without an offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct Dimension([i16; 6]);

/// The parts of one that exponents are counted in.
const PARTS: i16 = 60;
/// Largest exponent; beyond it there is no unit.
const MOST: f64 = 127.0;
/// How far a power of an exponent may be from a whole number of parts: rounding of `1/3`.
const ROUNDING: f64 = 1e-9;

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
    pub const ONE: Self = Self::of([0; 6]);
    pub const LENGTH: Self = Self::of([1, 0, 0, 0, 0, 0]);
    pub const TIME: Self = Self::of([0, 0, 1, 0, 0, 0]);
    pub const FREQUENCY: Self = Self::of([0, 0, -1, 0, 0, 0]);
    /// Of a frequency in cycles per length.
    pub const PER_LENGTH: Self = Self::of([-1, 0, 0, 0, 0, 0]);
    pub const SPEED: Self = Self::of([1, 0, -1, 0, 0, 0]);
    pub const ACCELERATION: Self = Self::of([1, 0, -2, 0, 0, 0]);
    pub const FORCE: Self = Self::of([1, 1, -2, 0, 0, 0]);

    /// Whole exponents of length, mass, time, temperature, electric current, and temperature in
    /// degrees Celsius.
    pub const fn of(exponents: [i8; 6]) -> Self {
        let mut parts = [0; 6];
        let mut at = 0;
        // No iterator is constant.
        while at < parts.len() {
            parts[at] = exponents[at] as i16 * PARTS;
            at += 1;
        }
        Self(parts)
    }

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
        Self::of(exponents)
    }

    /// `self` to a power. A plain number has any power.
    ///
    /// `None` if an exponent is too large, or is no whole number of sixtieths.
    pub fn power(self, exponent: f64) -> Option<Self> {
        let mut out = [0; 6];
        for (to, from) in out.iter_mut().zip(self.0) {
            let parts = f64::from(from) * exponent;
            let exact = (parts - parts.round()).abs() <= ROUNDING * parts.abs().max(1.0);
            if !(exact && parts.abs() <= MOST * f64::from(PARTS)) {
                return None;
            }
            *to = parts.round() as i16;
        }
        Some(Self(out))
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
            .map(|(name, exponent)| match exponent {
                PARTS => (*name).to_string(),
                _ => format!("{name}^{}", fraction(exponent)),
            })
            .collect();
        f.write_str(if parts.is_empty() { "-".to_string() } else { parts.join(" ") }.as_str())
    }
}

/// An exponent as printed: `2`, `-1.5`, `0.05`, `(1/3)`.
fn fraction(parts: i16) -> String {
    // A finite decimal has hundredths: 60 parts are 100 of them.
    if parts % 3 == 0 {
        return (f64::from(parts) / f64::from(PARTS)).to_string();
    }
    let common = (1..=PARTS).rev().find(|by| parts % by == 0 && PARTS % by == 0).unwrap_or(1);
    format!("({}/{})", parts / common, PARTS / common)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: exponents are exact fractions, also those that no float is.
    #[test]
    fn powers_are_exact() {
        let area = Dimension::LENGTH.power(2.0).expect("an area");
        let third = area.power(1.0 / 3.0).expect("two thirds");
        assert_eq!(third.to_string(), "m^(2/3)");
        assert_eq!(third.power(3.0), Some(area));
        assert_eq!(third * third * third, area);
        let root = (area / Dimension::TIME.power(3.0).expect("a cube")).power(0.5);
        assert_eq!(root.expect("a root").to_string(), "m s^-1.5");
        let power = Dimension::LENGTH * Dimension::FORCE / Dimension::TIME;
        assert_eq!(power.power(0.3).expect("tenths").to_string(), "m^0.6 kg^0.3 s^-0.9");
        assert_eq!(Dimension::LENGTH.power(0.05).expect("a twentieth").to_string(), "m^0.05");
        for none in [0.333, 1.0 / 7.0, 128.0, f64::NAN, f64::INFINITY] {
            assert_eq!(Dimension::LENGTH.power(none), None, "{none}");
        }
        assert_eq!(Dimension::ONE.power(0.333), Some(Dimension::ONE));
    }
}
