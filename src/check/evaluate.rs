//! Evaluates a checked expression, given the values of its names.

use std::ops::RangeInclusive;

use super::{
    possible::possible,
    prelude::*,
    values::{Values, leaf},
};
use crate::result::Reason;

/// The value of an expression. Where names have no value, the result is the value that the
/// expression has for every value of them, if there is one.
///
/// # Errors
/// The name that has no value, or the operation that is not defined (such as a division by zero).
pub fn evaluate(expr: &Expr, values: &dyn Values) -> Result<Scalar, Reason> {
    match exactly(expr, values) {
        // The other operands cannot decide a leaf without a value.
        Err(reason) if matches!(expr.kind, Kind::Binary(..) | Kind::Not(_) | Kind::Cases(..)) => {
            possible(expr, values).only_value().ok_or(reason)
        }
        found => found,
    }
}

fn exactly(expr: &Expr, values: &dyn Values) -> Result<Scalar, Reason> {
    let result = match &expr.kind {
        Kind::Negative(inner) => Scalar::Number(-number(inner, values)?),
        Kind::Not(inner) => Scalar::Flag(!flag(inner, values)?),
        Kind::Mapped(inner, mapping) => {
            let found = mapping.of(number(inner, values)?);
            if let (true, Mapping::Table(_)) = (found.is_nan(), mapping) {
                return Err(Reason::OutsideTable { of: words(inner), row: None, at: None });
            }
            Scalar::Number(found)
        }
        Kind::Binary(operator, left, right) => binary(*operator, left, right, values)?,
        Kind::Call(function, arguments) => {
            let arguments = arguments
                .iter()
                .map(|argument| number(argument, values))
                .collect::<Result<Vec<_>, _>>()?;
            Scalar::Number((function.run)(&arguments))
        }
        Kind::Cases(arms, otherwise) => {
            for (value, condition) in arms {
                if flag(condition, values)? {
                    return evaluate(value, values);
                }
            }
            match otherwise {
                Some(value) => evaluate(value, values)?,
                None => return Err(Reason::NoCaseOf { expression: words(expr) }),
            }
        }
        name => leaf(name, values)?,
    };
    match result {
        Scalar::Number(value) if !value.is_finite() => {
            Err(Reason::NotFinite { expression: words(expr) })
        }
        value => Ok(value),
    }
}

/// The value of an expression that is a number, SI.
///
/// # Errors
/// As [`evaluate`], or it is no number.
pub fn number(expr: &Expr, values: &dyn Values) -> Result<f64, Reason> {
    match evaluate(expr, values)? {
        Scalar::Number(value) => Ok(value),
        other => Err(Reason::NotNumber { expression: words(expr), value: format!("{other:?}") }),
    }
}

/// Whether a condition holds.
///
/// # Errors
/// As [`evaluate`], or it is no condition.
pub fn flag(expr: &Expr, values: &dyn Values) -> Result<bool, Reason> {
    match evaluate(expr, values)? {
        Scalar::Flag(value) => Ok(value),
        other => Err(Reason::NotCondition { expression: words(expr), value: format!("{other:?}") }),
    }
}

fn binary(
    operator: Operator,
    left: &Expr,
    right: &Expr,
    values: &dyn Values,
) -> Result<Scalar, Reason> {
    let flag = |part: &Expr| flag(part, values);
    let (a, b) = match operator {
        // If one side decides the result, the other may be missing: `direction is straight or
        // radius > 600 m`.
        Operator::And => return Ok(Scalar::Flag(flag(left)? && flag(right)?)),
        Operator::Or => return Ok(Scalar::Flag(flag(left)? || flag(right)?)),
        Operator::Is | Operator::IsNot => {
            let equal = evaluate(left, values)? == evaluate(right, values)?;
            return Ok(Scalar::Flag(equal == (operator == Operator::Is)));
        }
        _ => (number(left, values)?, number(right, values)?),
    };
    let room = values.rounding() * b.abs();
    Ok(match operator {
        Operator::Less => Scalar::Flag(a < b),
        Operator::LessEqual => Scalar::Flag(a <= b + room),
        Operator::Greater => Scalar::Flag(a > b),
        Operator::GreaterEqual => Scalar::Flag(a >= b - room),
        _ => Scalar::Number(arithmetic(operator, a, b)),
    })
}

/// A sum, a difference, a product or a quotient of two numbers; not a number for other operators.
pub fn arithmetic(operator: Operator, a: f64, b: f64) -> f64 {
    match operator {
        Operator::Add => a + b,
        Operator::Subtract => a - b,
        Operator::Multiply => a * b,
        Operator::Divide => a / b,
        _ => f64::NAN,
    }
}

/// Whether a value is a whole number within bounds.
pub fn is_whole(value: f64, bounds: RangeInclusive<f64>) -> bool {
    value.fract() == 0.0 && bounds.contains(&value)
}

/// The source text of an expression, with normalised blanks.
pub fn words(expr: &Expr) -> String {
    expr.span.words.to_string()
}

/// The structure of an expression without its place in the source. Two expressions with the same
/// structure always have the same value.
pub fn shape(expr: &Expr) -> String {
    let head = match &expr.kind {
        Kind::Constant(Scalar::Number(value)) => format!("{value:e}"),
        Kind::Constant(Scalar::Word(word)) => format!("'{word}'"),
        Kind::Constant(Scalar::Flag(flag)) => flag.to_string(),
        Kind::NotStated(parameter, _) => format!("parameter {parameter}"),
        Kind::Vehicle(index) => format!("vehicle{index}"),
        Kind::Column(index) => format!("column{index}"),
        Kind::Start => "start".into(),
        Kind::End => "end".into(),
        Kind::Input(index) => format!("in{index}"),
        Kind::Side(side) => side.in_words().into(),
        Kind::LimitOf(name) => format!("limit of {name}"),
        Kind::Channel { column, .. } => format!("channel {column}"),
        Kind::Negative(_) => "-".into(),
        Kind::Not(_) => "not".into(),
        Kind::Mapped(_, mapping) => mapping.to_string(),
        Kind::Binary(operator, ..) => format!("{operator:?}"),
        Kind::Call(function, _) => function.name.into(),
        Kind::Filtered(_, steps) => format!("{steps:?}"),
        Kind::OverAxis(operation, _) => format!("{operation:?}"),
        Kind::OfSection(operation, _) => format!("{operation:?}"),
        Kind::Frequency => "frequency".into(),
        Kind::Level(reducer, _) => format!("{} of", reducer.in_words()),
        Kind::Cases(arms, _) => format!("cases{}", arms.len()),
    };
    let parts: Vec<String> = expr.parts().into_iter().map(shape).collect();
    if parts.is_empty() { head } else { format!("{head}({})", parts.join(",")) }
}
