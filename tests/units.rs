//! Every unit symbol against an independent table.
//!
//! Factors: BIPM, "The International System of Units", 9th edition, tables 4, 7 and 8, and NIST Special Publication 811
//! (2008), appendix B.8; both give these values as exact.

use fishplate::units::{Dimension, SYMBOLS, Unit};

const PI: f64 = std::f64::consts::PI;

/// Symbol; how many of the SI unit one is, as a numerator and a denominator; exponents of m, kg, s, K, A.
const TABLE: [(&str, f64, f64, [i8; 5]); 56] = [
    ("-", 1.0, 1.0, [0, 0, 0, 0, 0]),
    ("1", 1.0, 1.0, [0, 0, 0, 0, 0]),
    ("%", 1.0, 100.0, [0, 0, 0, 0, 0]),
    ("‰", 1.0, 1000.0, [0, 0, 0, 0, 0]),
    ("ppm", 1.0, 1_000_000.0, [0, 0, 0, 0, 0]),
    ("rad", 1.0, 1.0, [0, 0, 0, 0, 0]),
    ("mrad", 1.0, 1000.0, [0, 0, 0, 0, 0]),
    ("deg", PI, 180.0, [0, 0, 0, 0, 0]),
    ("°", PI, 180.0, [0, 0, 0, 0, 0]),
    ("rev", 2.0 * PI, 1.0, [0, 0, 0, 0, 0]),
    ("m", 1.0, 1.0, [1, 0, 0, 0, 0]),
    ("km", 1000.0, 1.0, [1, 0, 0, 0, 0]),
    ("cm", 1.0, 100.0, [1, 0, 0, 0, 0]),
    ("mm", 1.0, 1000.0, [1, 0, 0, 0, 0]),
    ("um", 1.0, 1_000_000.0, [1, 0, 0, 0, 0]),
    ("µm", 1.0, 1_000_000.0, [1, 0, 0, 0, 0]),
    ("in", 254.0, 10_000.0, [1, 0, 0, 0, 0]),
    ("ft", 3048.0, 10_000.0, [1, 0, 0, 0, 0]),
    ("mi", 1_609_344.0, 1000.0, [1, 0, 0, 0, 0]),
    ("kg", 1.0, 1.0, [0, 1, 0, 0, 0]),
    ("g", 1.0, 1000.0, [0, 1, 0, 0, 0]),
    ("t", 1000.0, 1.0, [0, 1, 0, 0, 0]),
    ("s", 1.0, 1.0, [0, 0, 1, 0, 0]),
    ("ms", 1.0, 1000.0, [0, 0, 1, 0, 0]),
    ("us", 1.0, 1_000_000.0, [0, 0, 1, 0, 0]),
    ("µs", 1.0, 1_000_000.0, [0, 0, 1, 0, 0]),
    ("min", 60.0, 1.0, [0, 0, 1, 0, 0]),
    ("h", 3600.0, 1.0, [0, 0, 1, 0, 0]),
    ("Hz", 1.0, 1.0, [0, 0, -1, 0, 0]),
    ("kHz", 1000.0, 1.0, [0, 0, -1, 0, 0]),
    ("rpm", PI, 30.0, [0, 0, -1, 0, 0]),
    ("mph", 1_609_344.0, 3_600_000.0, [1, 0, -1, 0, 0]),
    ("gn", 980_665.0, 100_000.0, [1, 0, -2, 0, 0]),
    ("N", 1.0, 1.0, [1, 1, -2, 0, 0]),
    ("daN", 10.0, 1.0, [1, 1, -2, 0, 0]),
    ("kN", 1000.0, 1.0, [1, 1, -2, 0, 0]),
    ("MN", 1_000_000.0, 1.0, [1, 1, -2, 0, 0]),
    ("kgf", 980_665.0, 100_000.0, [1, 1, -2, 0, 0]),
    ("lbf", 44_482_216_152_605.0, 10_000_000_000_000.0, [1, 1, -2, 0, 0]),
    ("Nm", 1.0, 1.0, [2, 1, -2, 0, 0]),
    ("kNm", 1000.0, 1.0, [2, 1, -2, 0, 0]),
    ("MNm", 1_000_000.0, 1.0, [2, 1, -2, 0, 0]),
    ("J", 1.0, 1.0, [2, 1, -2, 0, 0]),
    ("kJ", 1000.0, 1.0, [2, 1, -2, 0, 0]),
    ("W", 1.0, 1.0, [2, 1, -3, 0, 0]),
    ("kW", 1000.0, 1.0, [2, 1, -3, 0, 0]),
    ("MW", 1_000_000.0, 1.0, [2, 1, -3, 0, 0]),
    ("Pa", 1.0, 1.0, [-1, 1, -2, 0, 0]),
    ("kPa", 1000.0, 1.0, [-1, 1, -2, 0, 0]),
    ("MPa", 1_000_000.0, 1.0, [-1, 1, -2, 0, 0]),
    ("GPa", 1_000_000_000.0, 1.0, [-1, 1, -2, 0, 0]),
    ("bar", 100_000.0, 1.0, [-1, 1, -2, 0, 0]),
    ("K", 1.0, 1.0, [0, 0, 0, 1, 0]),
    ("A", 1.0, 1.0, [0, 0, 0, 0, 1]),
    ("V", 1.0, 1.0, [2, 1, -3, 0, -1]),
    ("mV", 1.0, 1000.0, [2, 1, -3, 0, -1]),
];

#[test]
fn every_symbol_is_in_the_table_and_the_other_way_round() {
    let known: Vec<&str> = SYMBOLS.iter().map(|known| known.symbol).collect();
    let wanted: Vec<&str> = TABLE.iter().map(|(symbol, ..)| *symbol).collect();
    assert_eq!(known, wanted);
}

/// Both ways, to the last two digits of a double.
#[test]
fn factors_and_dimensions_are_those_of_the_table() {
    for (symbol, numerator, denominator, exponents) in TABLE {
        let unit = Unit::parse(symbol).unwrap_or_else(|error| panic!("{symbol}: {error:?}"));
        assert_eq!(unit.dimension, Dimension(exponents), "{symbol}");
        let factor = numerator / denominator;
        let near = |found: f64, wanted: f64| (found / wanted - 1.0).abs() < 5e-16;
        assert!(near(unit.to_si(1.0), factor), "{symbol}: {} is not {factor}", unit.to_si(1.0));
        assert!(near(unit.from_si(1.0), denominator / numerator), "{symbol}: {}", unit.from_si(1.0));
    }
}

/// Products, quotients and powers, worked out by hand.
#[test]
fn compound_units() {
    for (text, number, si) in [
        ("km/h", 3.6, 1.0),
        ("kN/mm", 2.0, 2.0e6),
        ("daN/t", 5.0, 0.05),
        ("mm^2", 4.0, 4.0e-6),
        ("1/km", 2.0, 2.0e-3),
        ("kNm/rad", 1.5, 1500.0),
    ] {
        let unit = Unit::parse(text).unwrap_or_else(|error| panic!("{text}: {error:?}"));
        assert!((unit.to_si(number) / si - 1.0).abs() < 5e-16, "{text}: {}", unit.to_si(number));
    }
}
