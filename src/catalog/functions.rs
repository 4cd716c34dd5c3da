//! Functions of expressions, for numbers and, sample by sample, for signals.

/// Dimensions of the arguments and of the result of a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signature {
    /// One argument of any dimension; the result has the same.
    Same,
    /// One argument of any dimension; the result is a plain number.
    ToPlain,
    /// One plain number; the result is a plain number.
    Plain,
    /// Square root, also of the dimension.
    Root,
    /// Two arguments of one dimension; the result has the same.
    PairSame,
}

#[derive(Debug)]
pub struct Function {
    pub name: &'static str,
    pub signature: Signature,
    pub about: &'static str,
    pub run: fn(&[f64]) -> f64,
}

const fn function(
    name: &'static str,
    signature: Signature,
    about: &'static str,
    run: fn(&[f64]) -> f64,
) -> Function {
    Function { name, signature, about, run }
}

/// The number of arguments is checked before: two for [`Signature::PairSame`], one for all others.
pub const FUNCTIONS: &[Function] = &[
    function(
        "larger",
        Signature::PairSame,
        "The larger of two values; also written `larger of a, b`.",
        |a| a[0].max(a[1]),
    ),
    function(
        "smaller",
        Signature::PairSame,
        "The smaller of two values; also written `smaller of a, b`.",
        |a| a[0].min(a[1]),
    ),
    function(
        "magnitude",
        Signature::Same,
        "The value without its sign; also written `|a|`.",
        |a| a[0].abs(),
    ),
    function(
        "sign",
        Signature::ToPlain,
        "1 for zero and positive values, -1 for negative values.",
        |a| if a[0] < 0.0 { -1.0 } else { 1.0 },
    ),
    function("sqrt", Signature::Root, "Square root.", |a| a[0].sqrt()),
    function("hypot", Signature::PairSame, "Square root of the sum of two squares.", |a| {
        a[0].hypot(a[1])
    }),
    function("exp", Signature::Plain, "Exponential function.", |a| a[0].exp()),
    function("ln", Signature::Plain, "Natural logarithm.", |a| a[0].ln()),
    function("log10", Signature::Plain, "Decimal logarithm.", |a| a[0].log10()),
    function("sin", Signature::Plain, "Sine of an angle.", |a| a[0].sin()),
    function("cos", Signature::Plain, "Cosine of an angle.", |a| a[0].cos()),
    function("tan", Signature::Plain, "Tangent of an angle.", |a| a[0].tan()),
    function("asin", Signature::Plain, "Inverse sine, an angle.", |a| a[0].asin()),
    function("acos", Signature::Plain, "Inverse cosine, an angle.", |a| a[0].acos()),
    function("atan", Signature::Plain, "Inverse tangent, an angle.", |a| a[0].atan()),
    function("floor", Signature::Plain, "The largest whole number that is not greater.", |a| {
        a[0].floor()
    }),
];

/// Functions of a signal along its axis: name, arguments and result, description.
pub const SIGNAL_FUNCTIONS: [(&str, &str, &str); 5] = [
    (
        "shifted",
        "(signal<D>, distance along the axis) -> signal<D>",
        "The signal moved forward: its value at x is the value at x minus the distance, with linear interpolation.",
    ),
    (
        "derivative",
        "(signal<D>) -> signal<D per axis>",
        "Slope at each sample: central differences; at the first and last sample the difference to the neighbour. With a second argument `time`, the derivative with respect to time.",
    ),
    (
        "integral",
        "(signal<D>) -> signal<D times axis>",
        "Integral by the trapezoidal rule, 0 at the first sample of the record. With a second argument `time`, the integral over time.",
    ),
    (
        "spectrum",
        "(signal<D>, segment: a time, overlap: a share, from: a frequency, to: a frequency) -> spectrum<D^2 per frequency>",
        "Power spectral density of the section, one-sided, by Welch's method: Hann windows of this length, each without its mean. The overlap (50 % unless said) and the band may be left out.",
    ),
    (
        "cycle_ranges",
        "(signal<D>) -> cycles<D>",
        "Ranges of the cycles of the section by rainflow counting (ASTM E1049-85, 5.4.4); a half cycle counts half.",
    ),
];
