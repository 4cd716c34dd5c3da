//! Possible values of an expression while some of its names have no value. A result is decided if
//! it is the same for every value of them.
//!
//! Numbers are bounded by intervals (interval arithmetic); conditions have three truth values
//! (Kleene logic). The bounds are never too narrow. They may be too wide where an unknown name
//! occurs twice.

use super::{
    prelude::*,
    values::{Values, leaf},
};
use crate::catalog::Function;
use crate::metrics::statistics::ends;
use crate::units::raised;

/// All values that an expression may have.
#[derive(Clone, Debug, PartialEq)]
pub enum Possible {
    /// From the first to the second, in SI.
    Number(f64, f64),
    Flag {
        can_hold: bool,
        can_fail: bool,
    },
    /// One of these; `None` where any word is possible.
    Words(Option<Vec<String>>),
}

impl Possible {
    fn of(value: Scalar) -> Self {
        match value {
            Scalar::Number(value) => Self::Number(value, value),
            Scalar::Flag(flag) => Self::flag(flag),
            Scalar::Word(word) => Self::Words(Some(vec![word])),
        }
    }

    fn flag(flag: bool) -> Self {
        Self::Flag { can_hold: flag, can_fail: !flag }
    }

    fn anything(ty: &Type) -> Self {
        match ty {
            Type::Number(_) | Type::Samples { .. } => {
                Self::Number(f64::NEG_INFINITY, f64::INFINITY)
            }
            Type::Flag | Type::SampleFlags { .. } => Self::Flag { can_hold: true, can_fail: true },
            Type::Word(words) => Self::Words(Some(words.clone()).filter(|words| !words.is_empty())),
        }
    }

    /// The only possible value, if there is just one.
    pub fn only_value(&self) -> Option<Scalar> {
        match self {
            Self::Number(low, high) if low == high && low.is_finite() => Some(Scalar::Number(*low)),
            Self::Flag { can_hold, can_fail } if can_hold != can_fail => {
                Some(Scalar::Flag(*can_hold))
            }
            Self::Words(Some(words)) if words.len() == 1 => Some(Scalar::Word(words[0].clone())),
            _ => None,
        }
    }

    fn with(self, other: Self) -> Self {
        match (self, other) {
            (Self::Number(a, b), Self::Number(c, d)) => Self::Number(a.min(c), b.max(d)),
            (Self::Flag { can_hold: a, can_fail: b }, Self::Flag { can_hold: c, can_fail: d }) => {
                Self::Flag { can_hold: a || c, can_fail: b || d }
            }
            (Self::Words(Some(mut words)), Self::Words(Some(more))) => {
                words.extend(more);
                words.sort();
                words.dedup();
                Self::Words(Some(words))
            }
            (Self::Words(_), _) => Self::Words(None),
            (first, _) => first,
        }
    }

    fn bounds(&self) -> (f64, f64) {
        if let Self::Number(low, high) = self {
            (*low, *high)
        } else {
            (f64::NEG_INFINITY, f64::INFINITY)
        }
    }

    /// Whether it can be true, and whether it can be false.
    fn holds(&self) -> (bool, bool) {
        if let Self::Flag { can_hold, can_fail } = self {
            (*can_hold, *can_fail)
        } else {
            (true, true)
        }
    }
}

/// The values that an expression may have. A name without a value may have any value of its type.
pub fn possible(expr: &Expr, values: &dyn Values) -> Possible {
    let of = |part: &Expr| possible(part, values);
    match &expr.kind {
        Kind::Negative(inner) => {
            let (low, high) = of(inner).bounds();
            Possible::Number(-high, -low)
        }
        Kind::Not(inner) => {
            let (can_hold, can_fail) = of(inner).holds();
            Possible::Flag { can_hold: can_fail, can_fail: can_hold }
        }
        Kind::Mapped(inner, Mapping::Power(exponent)) => power(of(inner).bounds(), *exponent),
        Kind::Mapped(inner, Mapping::Table(table)) => in_table(of(inner).bounds(), table),
        Kind::Binary(Operator::And, left, right) => {
            let ((a, b), (c, d)) = (of(left).holds(), of(right).holds());
            Possible::Flag { can_hold: a && c, can_fail: b || d }
        }
        Kind::Binary(Operator::Or, left, right) => {
            let ((a, b), (c, d)) = (of(left).holds(), of(right).holds());
            Possible::Flag { can_hold: a || c, can_fail: b && d }
        }
        Kind::Binary(operator @ (Operator::Is | Operator::IsNot), left, right) => {
            let (can_be, can_differ) = equal(&of(left), &of(right));
            let is = *operator == Operator::Is;
            Possible::Flag {
                can_hold: if is { can_be } else { can_differ },
                can_fail: if is { can_differ } else { can_be },
            }
        }
        Kind::Binary(operator, left, right) => {
            binary(*operator, of(left).bounds(), of(right).bounds())
        }
        Kind::Call(function, arguments) => call(
            function,
            &arguments.iter().map(|argument| of(argument).bounds()).collect::<Vec<_>>(),
        ),
        Kind::Cases(arms, otherwise) => {
            let mut all: Option<Possible> = None;
            let mut add = |value: Possible| {
                all = Some(
                    all.take().map_or_else(|| value.clone(), |before| before.with(value.clone())),
                )
            };
            let mut open = true;
            for (value, condition) in arms {
                let (can_hold, can_fail) = of(condition).holds();
                if can_hold {
                    add(of(value));
                }
                if !can_fail {
                    open = false;
                    break;
                }
            }
            match otherwise {
                Some(value) if open => add(of(value)),
                // Where no case applies, there is no value.
                None if open => return Possible::anything(&expr.ty),
                _ => {}
            }
            all.unwrap_or_else(|| Possible::anything(&expr.ty))
        }
        name => match leaf(name, values) {
            Ok(Scalar::Number(value)) if !value.is_finite() => Possible::anything(&expr.ty),
            Ok(value) => Possible::of(value),
            Err(_) => Possible::anything(&expr.ty),
        },
    }
}

/// An interval from an operation; it is unbounded where an end is not a number.
fn interval(low: f64, high: f64) -> Possible {
    if low.is_nan() || high.is_nan() {
        Possible::Number(f64::NEG_INFINITY, f64::INFINITY)
    } else {
        Possible::Number(low, high)
    }
}

fn corners((a, b): (f64, f64), (c, d): (f64, f64), operation: fn(f64, f64) -> f64) -> Possible {
    let all = [operation(a, c), operation(a, d), operation(b, c), operation(b, d)];
    if all.iter().any(|value| value.is_nan()) {
        return interval(f64::NAN, f64::NAN);
    }
    interval(
        all.into_iter().fold(f64::INFINITY, f64::min),
        all.into_iter().fold(f64::NEG_INFINITY, f64::max),
    )
}

fn binary(operator: Operator, left: (f64, f64), right: (f64, f64)) -> Possible {
    let ((a, b), (c, d)) = (left, right);
    let flag = |can_hold: bool, can_fail: bool| Possible::Flag { can_hold, can_fail };
    match operator {
        Operator::Add => interval(a + c, b + d),
        Operator::Subtract => interval(a - d, b - c),
        Operator::Multiply => corners(left, right, |x, y| x * y),
        Operator::Divide if c > 0.0 || d < 0.0 => corners(left, right, |x, y| x / y),
        Operator::Divide => interval(f64::NAN, f64::NAN),
        Operator::Less => flag(a < d, b >= c),
        Operator::LessEqual => flag(a <= d, b > c),
        Operator::Greater => flag(b > c, a <= d),
        Operator::GreaterEqual => flag(b >= c, a < d),
        Operator::Is | Operator::IsNot | Operator::And | Operator::Or => flag(true, true),
    }
}

/// The values between two numbers: those at both of them and at the points between.
fn in_table((low, high): (f64, f64), table: &Table) -> Possible {
    let (first, last) = table.ends();
    if !(table.held || first <= low && high <= last) {
        return interval(f64::NAN, f64::NAN);
    }
    let between = table.points.iter().filter(|(x, _)| (low..=high).contains(x)).map(|(_, y)| *y);
    let (least, most) = ends(between.chain([table.at(low), table.at(high)]));
    interval(least, most)
}

fn power((low, high): (f64, f64), exponent: f64) -> Possible {
    let (a, b) = (raised(low, exponent), raised(high, exponent));
    let crosses = low <= 0.0 && high >= 0.0;
    if exponent == 0.0 {
        return Possible::Number(1.0, 1.0);
    }
    let without = exponent < 0.0 && crosses || exponent.fract() != 0.0 && low < 0.0;
    match without {
        true => interval(f64::NAN, f64::NAN),
        false if exponent > 0.0 && exponent % 2.0 == 0.0 && crosses => interval(0.0, a.max(b)),
        false => interval(a.min(b), a.max(b)),
    }
}

fn call(function: &Function, arguments: &[(f64, f64)]) -> Possible {
    let at = |end: fn(&(f64, f64)) -> f64| {
        (function.run)(&arguments.iter().map(end).collect::<Vec<_>>())
    };
    let (low, high) = (at(|bounds| bounds.0), at(|bounds| bounds.1));
    let known = arguments.iter().all(|(low, high)| low == high);
    match function.name {
        _ if known => interval(low, high),
        // These functions are monotonically increasing in every argument.
        "larger" | "smaller" | "sign" | "floor" | "exp" => interval(low, high),
        "sqrt" | "ln" | "log10" if arguments[0].0 >= 0.0 => interval(low, high),
        "magnitude" if arguments[0].0 <= 0.0 && arguments[0].1 >= 0.0 => {
            interval(0.0, low.max(high))
        }
        "magnitude" => interval(low.min(high), low.max(high)),
        _ => interval(f64::NAN, f64::NAN),
    }
}

/// Whether two values can be equal, and whether they can differ.
fn equal(left: &Possible, right: &Possible) -> (bool, bool) {
    if let (Some(left), Some(right)) = (left.only_value(), right.only_value()) {
        return (left == right, left != right);
    }
    let can_be = match (left, right) {
        (Possible::Number(a, b), Possible::Number(c, d)) => a <= d && c <= b,
        (Possible::Words(Some(left)), Possible::Words(Some(right))) => {
            left.iter().any(|word| right.contains(word))
        }
        _ => true,
    };
    (can_be, true)
}

#[cfg(test)]
mod tests {
    use super::super::plan::Origin;
    use super::super::values::Nothing;
    use super::*;
    use crate::source::Source;
    use crate::units::Dimension;

    fn expr(kind: Kind, ty: Type) -> Expr {
        Expr { kind, ty, span: Origin { span: Source::new("t", "x").whole(), words: "x".into() } }
    }

    fn number(value: f64) -> Box<Expr> {
        Box::new(expr(Kind::Constant(Scalar::Number(value)), Type::Number(Dimension::ONE)))
    }

    fn unknown() -> Box<Expr> {
        Box::new(expr(Kind::Vehicle(0), Type::Number(Dimension::ONE)))
    }

    fn test(operator: Operator, left: Box<Expr>, right: Box<Expr>) -> Expr {
        expr(Kind::Binary(operator, left, right), Type::Flag)
    }

    #[test]
    fn cases_of_an_unknown_lie_between_their_values() {
        // 100 where x <= 140, 250 where x <= 220, otherwise 500
        let arms = vec![
            (*number(100.0), test(Operator::LessEqual, unknown(), number(140.0))),
            (*number(250.0), test(Operator::LessEqual, unknown(), number(220.0))),
        ];
        let cases = expr(Kind::Cases(arms, Some(number(500.0))), Type::Number(Dimension::ONE));
        assert_eq!(possible(&cases, &Nothing), Possible::Number(100.0, 500.0));
        let longer = |length: f64| {
            possible(
                &test(Operator::GreaterEqual, number(length), Box::new(cases.clone())),
                &Nothing,
            )
            .only_value()
        };
        assert_eq!(longer(500.0), Some(Scalar::Flag(true)));
        assert_eq!(longer(99.0), Some(Scalar::Flag(false)));
        assert_eq!(longer(200.0), None);
    }

    #[test]
    fn a_side_that_decides_alone_decides() {
        let yes = || Box::new(test(Operator::Less, number(1.0), number(2.0)));
        let open = || Box::new(test(Operator::Less, unknown(), number(2.0)));
        for (operator, left, right, one) in [
            (Operator::Or, open(), yes(), Some(true)),
            (Operator::And, open(), yes(), None),
            (Operator::Or, open(), open(), None),
        ] {
            assert_eq!(
                possible(&test(operator, left, right), &Nothing).only_value(),
                one.map(Scalar::Flag)
            );
        }
    }

    /// The interval of each operation contains all its values: compared with a grid of points.
    #[test]
    fn no_bound_is_too_narrow() {
        let intervals = [(-2.0, -0.5), (-1.0, 2.0), (0.0, 0.0), (0.5, 3.0)];
        let points = |(low, high): (f64, f64)| {
            (0..=8).map(move |step| low + (high - low) * f64::from(step) / 8.0)
        };
        let inside = |found: &Possible, value: f64| {
            let (low, high) = found.bounds();
            assert!(
                value.is_nan()
                    || value.is_infinite()
                    || (low - 1e-12..=high + 1e-12).contains(&value),
                "{value} of {found:?}"
            );
        };
        for left in intervals {
            for exponent in [-2.0, -1.0, -0.5, 0.0, 0.3, 1.0, 2.0, 3.0] {
                points(left).for_each(|x| inside(&power(left, exponent), raised(x, exponent)));
            }
            for function in crate::catalog::FUNCTIONS
                .iter()
                .filter(|function| function.signature != crate::catalog::Signature::PairSame)
            {
                points(left).for_each(|x| inside(&call(function, &[left]), (function.run)(&[x])));
            }
            for right in intervals {
                for (operator, of) in [
                    (Operator::Add, (|x, y| x + y) as fn(f64, f64) -> f64),
                    (Operator::Subtract, |x, y| x - y),
                    (Operator::Multiply, |x, y| x * y),
                    (Operator::Divide, |x, y| x / y),
                ] {
                    let found = binary(operator, left, right);
                    points(left).for_each(|x| points(right).for_each(|y| inside(&found, of(x, y))));
                }
                for function in crate::catalog::FUNCTIONS
                    .iter()
                    .filter(|function| function.signature == crate::catalog::Signature::PairSame)
                {
                    let found = call(function, &[left, right]);
                    points(left).for_each(|x| {
                        points(right).for_each(|y| inside(&found, (function.run)(&[x, y])))
                    });
                }
            }
        }
    }
}
