//! The known unit symbols. The language reference prints this table.

use std::sync::LazyLock;

use super::Dimension;

/// A unit symbol, its size in SI and its dimension.
#[derive(Debug)]
pub struct Symbol {
    pub symbol: &'static str,
    pub name: &'static str,
    pub factor: f64,
    pub dimension: Dimension,
}

const PI: f64 = std::f64::consts::PI;

/// Prefixes: sign, factor and name. `1` is the unit itself.
const PREFIXES: [(&str, f64, &str); 13] = [
    ("1", 1.0, ""),
    ("da", 1e1, "deca"),
    ("h", 1e2, "hecto"),
    ("k", 1e3, "kilo"),
    ("M", 1e6, "mega"),
    ("G", 1e9, "giga"),
    ("d", 1e-1, "deci"),
    ("c", 1e-2, "centi"),
    ("m", 1e-3, "milli"),
    ("u", 1e-6, "micro"),
    ("µ", 1e-6, "micro"),
    ("n", 1e-9, "nano"),
    ("p", 1e-12, "pico"),
];

/// Symbol, name, size in SI, and the prefixes that it has; a unit without prefixes stands for
/// itself.
type Unit = (&'static str, &'static str, f64, &'static str);

/// The units of each dimension, which is written in base units. A unit has no prefix that makes a
/// symbol mean two things, or that differs from a common one by a capital letter only: `Mm`, `Ms`,
/// `Mg` and `Gg` (mm, ms, mg); none of `t`, `h`, `min`, `in`, `ft`, `mi`, `rev`, `deg`, `rpm` and
/// `%` (`min` would be a thousandth of an inch, `ft` of a tonne); c, d, da and h only for the units
/// where they are common; and none beyond tera and pico.
///
/// A temperature in degrees Celsius has a zero of its own, and is therefore another dimension than
/// one in kelvin.
const UNITS: &[(&str, &[Unit])] = &[
    (
        "-",
        &[
            ("-", "plain number", 1.0, ""),
            ("1", "plain number", 1.0, ""),
            ("%", "per cent", 1e-2, ""),
            ("‰", "per mille", 1e-3, ""),
            ("ppm", "parts per million", 1e-6, ""),
            ("rad", "radian", 1.0, "1 m u µ"),
            ("deg", "degree of angle", PI / 180.0, ""),
            ("°", "degree of angle", PI / 180.0, ""),
            ("rev", "revolution", 2.0 * PI, ""),
        ],
    ),
    (
        "m",
        &[
            ("m", "metre", 1.0, "1 k c m u µ d n p"),
            ("in", "inch", 0.0254, ""),
            ("ft", "foot", 0.3048, ""),
            ("mi", "mile", 1609.344, ""),
        ],
    ),
    ("kg", &[("g", "gram", 1e-3, "k 1 m u µ"), ("t", "tonne", 1e3, "")]),
    (
        "s",
        &[
            ("s", "second", 1.0, "1 m u µ n p"),
            ("min", "minute", 60.0, ""),
            ("h", "hour", 3600.0, ""),
        ],
    ),
    (
        "s^-1",
        &[
            ("Hz", "hertz", 1.0, "1 k G M m"),
            ("rpm", "revolutions per minute", 2.0 * PI / 60.0, ""),
        ],
    ),
    ("m s^-1", &[("mph", "mile per hour", 1609.344 / 3600.0, "")]),
    ("m s^-2", &[("gn", "standard acceleration of gravity", 9.806_65, "")]),
    (
        "m kg s^-2",
        &[
            ("N", "newton", 1.0, "1 da k M m u µ"),
            ("kgf", "kilogram-force", 9.806_65, ""),
            ("lbf", "pound-force", 4.448_221_615_260_5, ""),
        ],
    ),
    (
        "m^2 kg s^-2",
        &[
            ("Nm", "newton metre", 1.0, "1 k M m u µ"),
            ("J", "joule", 1.0, "1 k G M m u µ"),
            ("Wh", "watt hour", 3600.0, "1 k"),
        ],
    ),
    ("m^2 kg s^-3", &[("W", "watt", 1.0, "1 k M G m u µ")]),
    ("m^-1 kg s^-2", &[("Pa", "pascal", 1.0, "1 k M G h m u µ"), ("bar", "bar", 1e5, "1 m")]),
    ("K", &[("K", "kelvin", 1.0, "1 m")]),
    ("A", &[("A", "ampere", 1.0, "1 k m u µ n")]),
    ("m^2 kg s^-3 A^-1", &[("V", "volt", 1.0, "1 m M k u µ n")]),
    (
        "m^3",
        &[
            ("l", "litre", 1e-3, ""),
            ("L", "litre", 1e-3, ""),
            ("l", "litre", 1e-3, "c d m"),
            ("L", "litre", 1e-3, "m"),
        ],
    ),
    ("m^2 kg s^-3 A^-2", &[("Ohm", "ohm", 1.0, "1 M k m u µ"), ("Ω", "ohm", 1.0, "1 M k m u µ")]),
    ("m^-2 kg^-1 s^3 A^2", &[("S", "siemens", 1.0, "1 m u µ")]),
    ("s A", &[("C", "coulomb", 1.0, "1 m u µ n p")]),
    ("m^-2 kg^-1 s^4 A^2", &[("F", "farad", 1.0, "1 m u µ n p")]),
    ("m^2 kg s^-2 A^-2", &[("H", "henry", 1.0, "1 m u µ n")]),
    ("m^2 kg s^-2 A^-1", &[("Wb", "weber", 1.0, "1 m")]),
    ("kg s^-2 A^-1", &[("T", "tesla", 1.0, "1 m u µ")]),
    ("degC", &[("degC", "degree Celsius", 1.0, ""), ("°C", "degree Celsius", 1.0, "")]),
];

/// All symbols, with their prefixes.
pub static SYMBOLS: LazyLock<Vec<Symbol>> = LazyLock::new(|| {
    let mut symbols = Vec::new();
    for (dimension, units) in UNITS {
        let dimension = Dimension::in_base_units(dimension);
        for (symbol, name, size, prefixes) in *units {
            let prefixes = if prefixes.is_empty() { "1" } else { *prefixes };
            for prefix in prefixes.split(' ') {
                let known = PREFIXES.iter().filter(|(sign, ..)| *sign == prefix);
                symbols.extend(known.map(|(sign, factor, prefix)| Symbol {
                    symbol: format!("{}{symbol}", sign.trim_start_matches('1')).leak(),
                    name: format!("{prefix}{name}").leak(),
                    factor: size * factor,
                    dimension,
                }));
            }
        }
    }
    symbols
});
