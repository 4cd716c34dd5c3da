//! Units: a [`Dimension`] is the type of an expression; a [`Unit`] is for reading and printing
//! numbers.
//!
//! Inside the program all numbers are in SI base units; conversion takes place where text is read
//! or printed.

mod dimension;
pub mod number;
mod parse;
mod table;

pub use dimension::Dimension;
pub use number::number_end;
pub use table::{SYMBOLS, Symbol};

use std::fmt;

/// A unit of measurement: `value_in_SI = number * factor`.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// As printed, for instance `m/s^2`; `-` for a dimensionless number.
    pub text: String,
    pub factor: f64,
    pub dimension: Dimension,
}

impl Unit {
    /// Reads `kN`, `m/s^2`, `m/s²`, `N s/m`, `1/m`, `kN*m`, `-`, `%` and the like.
    ///
    /// # Errors
    /// The part of the text that is not a unit, with the nearest known symbol.
    pub fn parse(text: &str) -> Result<Self, UnknownUnit> {
        parse::unit(text)
    }

    /// Help for a number whose unit is of another dimension than the one wanted, and begins like a
    /// unit of that: `0.65 g` where an acceleration is wanted.
    pub fn meant(number: &str, wanted: Dimension) -> Option<String> {
        parse::meant(number, wanted)
    }

    /// The unit of a dimensionless number.
    pub fn one() -> Self {
        Self { text: "-".into(), factor: 1.0, dimension: Dimension::ONE }
    }

    /// The unit that is listed beside a name; that of a dimensionless number if none is.
    pub fn of(name: &str, units: &[(String, Self)]) -> Self {
        let known = units.iter().find(|(known, _)| known == name);
        known.map_or_else(Self::one, |(_, unit)| unit.clone())
    }

    /// The SI unit of a dimension.
    pub fn si(dimension: Dimension) -> Self {
        if dimension == Dimension::ONE {
            Self::one()
        } else {
            Self { text: dimension.to_string(), factor: 1.0, dimension }
        }
    }

    /// Whether two texts are the same unit: the same words, or known units of the same size.
    pub fn same(one: &str, other: &str) -> bool {
        let size =
            |text: &str| Self::parse(text.trim()).ok().map(|unit| (unit.dimension, unit.factor));
        one.trim() == other.trim() || size(one).is_some_and(|one| Some(one) == size(other))
    }

    pub fn to_si(&self, number: f64) -> f64 {
        number * self.factor
    }

    pub fn from_si(&self, value: f64) -> f64 {
        value / self.factor
    }

    /// The unit after a number in text: ` kN`, or nothing for a dimensionless number.
    pub fn suffix(&self) -> String {
        if self.text == "-" { String::new() } else { format!(" {}", self.text) }
    }
}

/// A number to a power: by multiplications where the exponent is whole. Not a number for a negative
/// one and an exponent that is not whole.
pub fn raised(number: f64, exponent: f64) -> f64 {
    let whole = exponent.fract() == 0.0 && exponent.abs() <= f64::from(i8::MAX);
    if whole { number.powi(exponent as i32) } else { number.powf(exponent) }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// A word in a unit text that is not a known unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownUnit {
    pub word: String,
    pub near: Option<&'static str>,
}
