//! Functions of expressions, for numbers and, sample by sample, for signals.

/// What a function asks of its arguments' dimensions and what comes out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signature {
    /// One argument of any dimension, the same comes out.
    Same,
    /// One argument of any dimension, a plain number comes out.
    ToPlain,
    /// One plain number, a plain number comes out.
    Plain,
    /// The square root also of the dimension.
    Root,
    /// Two arguments of one dimension, the same comes out.
    PairSame,
}

#[derive(Debug)]
pub struct Function {
    pub name: &'static str,
    pub signature: Signature,
    pub about: &'static str,
    pub run: fn(&[f64]) -> f64,
}

const fn one(name: &'static str, signature: Signature, about: &'static str, run: fn(&[f64]) -> f64) -> Function {
    Function { name, signature, about, run }
}

/// Arguments are checked before: a function of [`Signature::PairSame`] gets two, every other one.
pub const FUNCTIONS: &[Function] = &[
    one("larger", Signature::PairSame, "The larger of two values; also written `larger of a, b`.", |a| a[0].max(a[1])),
    one("smaller", Signature::PairSame, "The smaller of two values; also written `smaller of a, b`.", |a| a[0].min(a[1])),
    one("magnitude", Signature::Same, "The value without its sign; also written `|a|`.", |a| a[0].abs()),
    one("sign", Signature::ToPlain, "1 for zero and above, -1 below.", |a| if a[0] < 0.0 { -1.0 } else { 1.0 }),
    one("sqrt", Signature::Root, "Square root.", |a| a[0].sqrt()),
    one("hypot", Signature::PairSame, "Square root of the sum of two squares.", |a| a[0].hypot(a[1])),
    one("exp", Signature::Plain, "Exponential function.", |a| a[0].exp()),
    one("ln", Signature::Plain, "Natural logarithm.", |a| a[0].ln()),
    one("log10", Signature::Plain, "Decimal logarithm.", |a| a[0].log10()),
    one("sin", Signature::Plain, "Sine of an angle.", |a| a[0].sin()),
    one("cos", Signature::Plain, "Cosine of an angle.", |a| a[0].cos()),
    one("tan", Signature::Plain, "Tangent of an angle.", |a| a[0].tan()),
    one("asin", Signature::Plain, "Inverse sine, an angle.", |a| a[0].asin()),
    one("acos", Signature::Plain, "Inverse cosine, an angle.", |a| a[0].acos()),
    one("atan", Signature::Plain, "Inverse tangent, an angle.", |a| a[0].atan()),
    one("floor", Signature::Plain, "The next whole number below.", |a| a[0].floor()),
];

/// Functions of a signal along its axis: name, what it takes and gives, what it is. Only signals have them.
pub const SIGNAL_FUNCTIONS: [(&str, &str, &str); 3] = [
    (
        "shifted",
        "(signal<D>, distance along the axis) -> signal<D>",
        "The signal moved forward: at x it has the value from x less the distance, linear between samples.",
    ),
    (
        "derivative",
        "(signal<D>) -> signal<D per axis>",
        "Slope at each sample: central differences, at the first and last sample the difference to its neighbour. With a second argument `time`, per time.",
    ),
    (
        "integral",
        "(signal<D>) -> signal<D times axis>",
        "Integral by trapezoids, 0 at the first sample of the record. With a second argument `time`, over time.",
    ),
];
