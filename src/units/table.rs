//! The known unit symbols. The language reference prints this table.

use super::Dimension;

/// A unit symbol, its size in SI and its dimension.
#[derive(Debug)]
pub struct Symbol {
    pub symbol: &'static str,
    pub name: &'static str,
    pub factor: f64,
    pub dimension: Dimension,
}

const fn unit(symbol: &'static str, name: &'static str, factor: f64, dimension: [i8; 5]) -> Symbol {
    Symbol { symbol, name, factor, dimension: Dimension(dimension) }
}

const ONE: [i8; 5] = [0; 5];
const LENGTH: [i8; 5] = [1, 0, 0, 0, 0];
const MASS: [i8; 5] = [0, 1, 0, 0, 0];
const TIME: [i8; 5] = [0, 0, 1, 0, 0];
const FREQUENCY: [i8; 5] = [0, 0, -1, 0, 0];
const FORCE: [i8; 5] = [1, 1, -2, 0, 0];
const ENERGY: [i8; 5] = [2, 1, -2, 0, 0];
const POWER: [i8; 5] = [2, 1, -3, 0, 0];
const PRESSURE: [i8; 5] = [-1, 1, -2, 0, 0];
const PI: f64 = std::f64::consts::PI;

/// All symbols including their prefixes, so that none is composed (`kN` is known, `mN` is not).
pub const SYMBOLS: &[Symbol] = &[
    unit("-", "plain number", 1.0, ONE),
    unit("1", "plain number", 1.0, ONE),
    unit("%", "per cent", 1e-2, ONE),
    unit("‰", "per mille", 1e-3, ONE),
    unit("ppm", "parts per million", 1e-6, ONE),
    unit("rad", "radian", 1.0, ONE),
    unit("mrad", "milliradian", 1e-3, ONE),
    unit("deg", "degree of angle", PI / 180.0, ONE),
    unit("°", "degree of angle", PI / 180.0, ONE),
    unit("rev", "revolution", 2.0 * PI, ONE),
    unit("m", "metre", 1.0, LENGTH),
    unit("km", "kilometre", 1e3, LENGTH),
    unit("cm", "centimetre", 1e-2, LENGTH),
    unit("mm", "millimetre", 1e-3, LENGTH),
    unit("um", "micrometre", 1e-6, LENGTH),
    unit("µm", "micrometre", 1e-6, LENGTH),
    unit("in", "inch", 0.0254, LENGTH),
    unit("ft", "foot", 0.3048, LENGTH),
    unit("mi", "mile", 1609.344, LENGTH),
    unit("kg", "kilogram", 1.0, MASS),
    unit("g", "gram", 1e-3, MASS),
    unit("t", "tonne", 1e3, MASS),
    unit("s", "second", 1.0, TIME),
    unit("ms", "millisecond", 1e-3, TIME),
    unit("us", "microsecond", 1e-6, TIME),
    unit("µs", "microsecond", 1e-6, TIME),
    unit("min", "minute", 60.0, TIME),
    unit("h", "hour", 3600.0, TIME),
    unit("Hz", "hertz", 1.0, FREQUENCY),
    unit("kHz", "kilohertz", 1e3, FREQUENCY),
    unit("rpm", "revolutions per minute", 2.0 * PI / 60.0, FREQUENCY),
    unit("mph", "mile per hour", 1609.344 / 3600.0, [1, 0, -1, 0, 0]),
    unit("gn", "standard acceleration of gravity", 9.806_65, [1, 0, -2, 0, 0]),
    unit("N", "newton", 1.0, FORCE),
    unit("daN", "decanewton", 10.0, FORCE),
    unit("kN", "kilonewton", 1e3, FORCE),
    unit("MN", "meganewton", 1e6, FORCE),
    unit("kgf", "kilogram-force", 9.806_65, FORCE),
    unit("lbf", "pound-force", 4.448_221_615_260_5, FORCE),
    unit("Nm", "newton metre", 1.0, ENERGY),
    unit("kNm", "kilonewton metre", 1e3, ENERGY),
    unit("MNm", "meganewton metre", 1e6, ENERGY),
    unit("J", "joule", 1.0, ENERGY),
    unit("kJ", "kilojoule", 1e3, ENERGY),
    unit("W", "watt", 1.0, POWER),
    unit("kW", "kilowatt", 1e3, POWER),
    unit("MW", "megawatt", 1e6, POWER),
    unit("Pa", "pascal", 1.0, PRESSURE),
    unit("kPa", "kilopascal", 1e3, PRESSURE),
    unit("MPa", "megapascal", 1e6, PRESSURE),
    unit("GPa", "gigapascal", 1e9, PRESSURE),
    unit("bar", "bar", 1e5, PRESSURE),
    unit("K", "kelvin", 1.0, [0, 0, 0, 1, 0]),
    unit("A", "ampere", 1.0, [0, 0, 0, 0, 1]),
    unit("V", "volt", 1.0, [2, 1, -3, 0, -1]),
    unit("mV", "millivolt", 1e-3, [2, 1, -3, 0, -1]),
];
