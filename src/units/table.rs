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

const fn unit(symbol: &'static str, name: &'static str, factor: f64, dimension: [i8; 6]) -> Symbol {
    Symbol { symbol, name, factor, dimension: Dimension(dimension) }
}

const ONE: [i8; 6] = [0; 6];
const LENGTH: [i8; 6] = [1, 0, 0, 0, 0, 0];
const MASS: [i8; 6] = [0, 1, 0, 0, 0, 0];
const TIME: [i8; 6] = [0, 0, 1, 0, 0, 0];
const FREQUENCY: [i8; 6] = [0, 0, -1, 0, 0, 0];
const FORCE: [i8; 6] = [1, 1, -2, 0, 0, 0];
const ENERGY: [i8; 6] = [2, 1, -2, 0, 0, 0];
const POWER: [i8; 6] = [2, 1, -3, 0, 0, 0];
const PRESSURE: [i8; 6] = [-1, 1, -2, 0, 0, 0];
const VOLUME: [i8; 6] = [3, 0, 0, 0, 0, 0];
const TEMPERATURE: [i8; 6] = [0, 0, 0, 1, 0, 0];
const CURRENT: [i8; 6] = [0, 0, 0, 0, 1, 0];
const VOLTAGE: [i8; 6] = [2, 1, -3, 0, -1, 0];
const RESISTANCE: [i8; 6] = [2, 1, -3, 0, -2, 0];
const CONDUCTANCE: [i8; 6] = [-2, -1, 3, 0, 2, 0];
const CHARGE: [i8; 6] = [0, 0, 1, 0, 1, 0];
const CAPACITANCE: [i8; 6] = [-2, -1, 4, 0, 2, 0];
const INDUCTANCE: [i8; 6] = [2, 1, -2, 0, -2, 0];
const FLUX: [i8; 6] = [2, 1, -2, 0, -1, 0];
const FLUX_DENSITY: [i8; 6] = [0, 1, -2, 0, -1, 0];
/// A temperature in degrees Celsius has a zero of its own, and is therefore another dimension than
/// one in kelvin.
const CELSIUS: [i8; 6] = [0, 0, 0, 0, 0, 1];
const PI: f64 = std::f64::consts::PI;

/// All symbols including their prefixes, so that none is composed. Refused are prefixes that make a
/// symbol mean two things, or that differ from a common one by a capital letter only: `Mm`, `Ms`,
/// `Mg` and `Gg` (mm, ms, mg); every prefix of `t`, `h`, `min`, `in`, `ft`, `mi`, `rev`, `deg`,
/// `rpm` and `%` (`min` would be a thousandth of an inch, `ft` of a tonne); c, d, da and h but for
/// the symbols below; and the prefixes beyond tera and pico.
pub const SYMBOLS: &[Symbol] = &[
    unit("-", "plain number", 1.0, ONE),
    unit("1", "plain number", 1.0, ONE),
    unit("%", "per cent", 1e-2, ONE),
    unit("‰", "per mille", 1e-3, ONE),
    unit("ppm", "parts per million", 1e-6, ONE),
    unit("rad", "radian", 1.0, ONE),
    unit("mrad", "milliradian", 1e-3, ONE),
    unit("urad", "microradian", 1e-6, ONE),
    unit("µrad", "microradian", 1e-6, ONE),
    unit("deg", "degree of angle", PI / 180.0, ONE),
    unit("°", "degree of angle", PI / 180.0, ONE),
    unit("rev", "revolution", 2.0 * PI, ONE),
    unit("m", "metre", 1.0, LENGTH),
    unit("km", "kilometre", 1e3, LENGTH),
    unit("cm", "centimetre", 1e-2, LENGTH),
    unit("mm", "millimetre", 1e-3, LENGTH),
    unit("um", "micrometre", 1e-6, LENGTH),
    unit("µm", "micrometre", 1e-6, LENGTH),
    unit("dm", "decimetre", 1e-1, LENGTH),
    unit("nm", "nanometre", 1e-9, LENGTH),
    unit("pm", "picometre", 1e-12, LENGTH),
    unit("in", "inch", 0.0254, LENGTH),
    unit("ft", "foot", 0.3048, LENGTH),
    unit("mi", "mile", 1609.344, LENGTH),
    unit("kg", "kilogram", 1.0, MASS),
    unit("g", "gram", 1e-3, MASS),
    unit("mg", "milligram", 1e-6, MASS),
    unit("ug", "microgram", 1e-9, MASS),
    unit("µg", "microgram", 1e-9, MASS),
    unit("t", "tonne", 1e3, MASS),
    unit("s", "second", 1.0, TIME),
    unit("ms", "millisecond", 1e-3, TIME),
    unit("us", "microsecond", 1e-6, TIME),
    unit("µs", "microsecond", 1e-6, TIME),
    unit("ns", "nanosecond", 1e-9, TIME),
    unit("ps", "picosecond", 1e-12, TIME),
    unit("min", "minute", 60.0, TIME),
    unit("h", "hour", 3600.0, TIME),
    unit("Hz", "hertz", 1.0, FREQUENCY),
    unit("kHz", "kilohertz", 1e3, FREQUENCY),
    unit("GHz", "gigahertz", 1e9, FREQUENCY),
    unit("MHz", "megahertz", 1e6, FREQUENCY),
    unit("mHz", "millihertz", 1e-3, FREQUENCY),
    unit("rpm", "revolutions per minute", 2.0 * PI / 60.0, FREQUENCY),
    unit("mph", "mile per hour", 1609.344 / 3600.0, [1, 0, -1, 0, 0, 0]),
    unit("gn", "standard acceleration of gravity", 9.806_65, [1, 0, -2, 0, 0, 0]),
    unit("N", "newton", 1.0, FORCE),
    unit("daN", "decanewton", 10.0, FORCE),
    unit("kN", "kilonewton", 1e3, FORCE),
    unit("MN", "meganewton", 1e6, FORCE),
    unit("mN", "millinewton", 1e-3, FORCE),
    unit("uN", "micronewton", 1e-6, FORCE),
    unit("µN", "micronewton", 1e-6, FORCE),
    unit("kgf", "kilogram-force", 9.806_65, FORCE),
    unit("lbf", "pound-force", 4.448_221_615_260_5, FORCE),
    unit("Nm", "newton metre", 1.0, ENERGY),
    unit("kNm", "kilonewton metre", 1e3, ENERGY),
    unit("MNm", "meganewton metre", 1e6, ENERGY),
    unit("mNm", "millinewton metre", 1e-3, ENERGY),
    unit("uNm", "micronewton metre", 1e-6, ENERGY),
    unit("µNm", "micronewton metre", 1e-6, ENERGY),
    unit("J", "joule", 1.0, ENERGY),
    unit("kJ", "kilojoule", 1e3, ENERGY),
    unit("GJ", "gigajoule", 1e9, ENERGY),
    unit("MJ", "megajoule", 1e6, ENERGY),
    unit("mJ", "millijoule", 1e-3, ENERGY),
    unit("uJ", "microjoule", 1e-6, ENERGY),
    unit("µJ", "microjoule", 1e-6, ENERGY),
    unit("Wh", "watt hour", 3600.0, ENERGY),
    unit("kWh", "kilowatt hour", 3.6e6, ENERGY),
    unit("W", "watt", 1.0, POWER),
    unit("kW", "kilowatt", 1e3, POWER),
    unit("MW", "megawatt", 1e6, POWER),
    unit("GW", "gigawatt", 1e9, POWER),
    unit("mW", "milliwatt", 1e-3, POWER),
    unit("uW", "microwatt", 1e-6, POWER),
    unit("µW", "microwatt", 1e-6, POWER),
    unit("Pa", "pascal", 1.0, PRESSURE),
    unit("kPa", "kilopascal", 1e3, PRESSURE),
    unit("MPa", "megapascal", 1e6, PRESSURE),
    unit("GPa", "gigapascal", 1e9, PRESSURE),
    unit("hPa", "hectopascal", 100.0, PRESSURE),
    unit("mPa", "millipascal", 1e-3, PRESSURE),
    unit("uPa", "micropascal", 1e-6, PRESSURE),
    unit("µPa", "micropascal", 1e-6, PRESSURE),
    unit("bar", "bar", 1e5, PRESSURE),
    unit("mbar", "millibar", 100.0, PRESSURE),
    unit("K", "kelvin", 1.0, TEMPERATURE),
    unit("mK", "millikelvin", 1e-3, TEMPERATURE),
    unit("A", "ampere", 1.0, CURRENT),
    unit("kA", "kiloampere", 1e3, CURRENT),
    unit("mA", "milliampere", 1e-3, CURRENT),
    unit("uA", "microampere", 1e-6, CURRENT),
    unit("µA", "microampere", 1e-6, CURRENT),
    unit("nA", "nanoampere", 1e-9, CURRENT),
    unit("V", "volt", 1.0, VOLTAGE),
    unit("mV", "millivolt", 1e-3, VOLTAGE),
    unit("MV", "megavolt", 1e6, VOLTAGE),
    unit("kV", "kilovolt", 1e3, VOLTAGE),
    unit("uV", "microvolt", 1e-6, VOLTAGE),
    unit("µV", "microvolt", 1e-6, VOLTAGE),
    unit("nV", "nanovolt", 1e-9, VOLTAGE),
    unit("l", "litre", 1e-3, VOLUME),
    unit("L", "litre", 1e-3, VOLUME),
    unit("cl", "centilitre", 1e-5, VOLUME),
    unit("dl", "decilitre", 1e-4, VOLUME),
    unit("ml", "millilitre", 1e-6, VOLUME),
    unit("mL", "millilitre", 1e-6, VOLUME),
    unit("Ohm", "ohm", 1.0, RESISTANCE),
    unit("MOhm", "megaohm", 1e6, RESISTANCE),
    unit("kOhm", "kiloohm", 1e3, RESISTANCE),
    unit("mOhm", "milliohm", 1e-3, RESISTANCE),
    unit("uOhm", "microohm", 1e-6, RESISTANCE),
    unit("µOhm", "microohm", 1e-6, RESISTANCE),
    unit("Ω", "ohm", 1.0, RESISTANCE),
    unit("MΩ", "megaohm", 1e6, RESISTANCE),
    unit("kΩ", "kiloohm", 1e3, RESISTANCE),
    unit("mΩ", "milliohm", 1e-3, RESISTANCE),
    unit("uΩ", "microohm", 1e-6, RESISTANCE),
    unit("µΩ", "microohm", 1e-6, RESISTANCE),
    unit("S", "siemens", 1.0, CONDUCTANCE),
    unit("mS", "millisiemens", 1e-3, CONDUCTANCE),
    unit("uS", "microsiemens", 1e-6, CONDUCTANCE),
    unit("µS", "microsiemens", 1e-6, CONDUCTANCE),
    unit("C", "coulomb", 1.0, CHARGE),
    unit("mC", "millicoulomb", 1e-3, CHARGE),
    unit("uC", "microcoulomb", 1e-6, CHARGE),
    unit("µC", "microcoulomb", 1e-6, CHARGE),
    unit("nC", "nanocoulomb", 1e-9, CHARGE),
    unit("pC", "picocoulomb", 1e-12, CHARGE),
    unit("F", "farad", 1.0, CAPACITANCE),
    unit("mF", "millifarad", 1e-3, CAPACITANCE),
    unit("uF", "microfarad", 1e-6, CAPACITANCE),
    unit("µF", "microfarad", 1e-6, CAPACITANCE),
    unit("nF", "nanofarad", 1e-9, CAPACITANCE),
    unit("pF", "picofarad", 1e-12, CAPACITANCE),
    unit("H", "henry", 1.0, INDUCTANCE),
    unit("mH", "millihenry", 1e-3, INDUCTANCE),
    unit("uH", "microhenry", 1e-6, INDUCTANCE),
    unit("µH", "microhenry", 1e-6, INDUCTANCE),
    unit("nH", "nanohenry", 1e-9, INDUCTANCE),
    unit("Wb", "weber", 1.0, FLUX),
    unit("mWb", "milliweber", 1e-3, FLUX),
    unit("T", "tesla", 1.0, FLUX_DENSITY),
    unit("mT", "millitesla", 1e-3, FLUX_DENSITY),
    unit("uT", "microtesla", 1e-6, FLUX_DENSITY),
    unit("µT", "microtesla", 1e-6, FLUX_DENSITY),
    unit("degC", "degree Celsius", 1.0, CELSIUS),
    unit("°C", "degree Celsius", 1.0, CELSIUS),
];
