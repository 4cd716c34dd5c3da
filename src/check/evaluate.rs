//! Evaluates a checked expression, given the values of its names.

use super::plan::{Expr, Kind, Operator, Scalar};
use super::possible::possible;
use super::values::{Values, leaf};

/// The value of an expression. Where names have no value, the result is the value that the
/// expression has for every value of them, if there is one.
///
/// # Errors
/// The name that has no value, or the operation that is not defined (such as a division by zero).
pub fn evaluate(expr: &Expr, values: &dyn Values) -> Result<Scalar, String> {
    match exactly(expr, values) {
        // The other operands cannot decide a leaf without a value.
        Err(reason) if matches!(expr.kind, Kind::Binary(..) | Kind::Not(_) | Kind::Cases(..)) => {
            possible(expr, values).one().ok_or(reason)
        }
        found => found,
    }
}

fn exactly(expr: &Expr, values: &dyn Values) -> Result<Scalar, String> {
    let result = match &expr.kind {
        Kind::Negative(inner) => Scalar::Number(-number(inner, values)?),
        Kind::Not(inner) => Scalar::Flag(!flag(inner, values)?),
        Kind::Power(inner, exponent) => {
            Scalar::Number(number(inner, values)?.powi(i32::from(*exponent)))
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
                None => return Err(format!("no case of `{}` applies", words(expr))),
            }
        }
        name => leaf(name, values)?,
    };
    match result {
        Scalar::Number(value) if !value.is_finite() => {
            Err(format!("`{}` is not a finite number", words(expr)))
        }
        value => Ok(value),
    }
}

pub fn number(expr: &Expr, values: &dyn Values) -> Result<f64, String> {
    match evaluate(expr, values)? {
        Scalar::Number(value) => Ok(value),
        other => Err(format!("`{}` is {other:?}, not a number", words(expr))),
    }
}

pub fn flag(expr: &Expr, values: &dyn Values) -> Result<bool, String> {
    match evaluate(expr, values)? {
        Scalar::Flag(value) => Ok(value),
        other => Err(format!("`{}` is {other:?}, not a condition", words(expr))),
    }
}

fn binary(
    operator: Operator,
    left: &Expr,
    right: &Expr,
    values: &dyn Values,
) -> Result<Scalar, String> {
    Ok(match operator {
        // If one side decides the result, the other may be missing: `direction is straight or
        // radius > 600 m`.
        Operator::And => Scalar::Flag(flag(left, values)? && flag(right, values)?),
        Operator::Or => Scalar::Flag(flag(left, values)? || flag(right, values)?),
        Operator::Is => Scalar::Flag(evaluate(left, values)? == evaluate(right, values)?),
        Operator::IsNot => Scalar::Flag(evaluate(left, values)? != evaluate(right, values)?),
        Operator::Add => Scalar::Number(number(left, values)? + number(right, values)?),
        Operator::Subtract => Scalar::Number(number(left, values)? - number(right, values)?),
        Operator::Multiply => Scalar::Number(number(left, values)? * number(right, values)?),
        Operator::Divide => Scalar::Number(number(left, values)? / number(right, values)?),
        Operator::Less => Scalar::Flag(number(left, values)? < number(right, values)?),
        Operator::LessEqual => {
            let (left, right) = (number(left, values)?, number(right, values)?);
            Scalar::Flag(left <= right + values.rounding() * right.abs())
        }
        Operator::Greater => Scalar::Flag(number(left, values)? > number(right, values)?),
        Operator::GreaterEqual => {
            let (left, right) = (number(left, values)?, number(right, values)?);
            Scalar::Flag(left >= right - values.rounding() * right.abs())
        }
    })
}

/// The source text of an expression, with normalised blanks.
pub fn words(expr: &Expr) -> String {
    expr.span.words.to_string()
}

/// The structure of an expression without its place in the source. Two expressions with the same
/// structure always have the same value.
pub fn shape(expr: &Expr) -> String {
    match &expr.kind {
        Kind::Constant(Scalar::Number(value)) => format!("{value:e}"),
        Kind::Constant(Scalar::Word(word)) => format!("'{word}'"),
        Kind::Constant(Scalar::Flag(flag)) => flag.to_string(),
        Kind::Vehicle(index) => format!("vehicle{index}"),
        Kind::Column(index) => format!("column{index}"),
        Kind::Start => "start".into(),
        Kind::End => "end".into(),
        Kind::Input(index) => format!("in{index}"),
        Kind::Simulated => "simulated".into(),
        Kind::Measured => "measured".into(),
        Kind::LimitOf(name) => format!("limit of {name}"),
        Kind::Negative(inner) => format!("-({})", shape(inner)),
        Kind::Not(inner) => format!("not({})", shape(inner)),
        Kind::Power(inner, exponent) => format!("({})^{exponent}", shape(inner)),
        Kind::Binary(operator, left, right) => {
            format!("{operator:?}({},{})", shape(left), shape(right))
        }
        Kind::Call(function, arguments) => format!(
            "{}({})",
            function.name,
            arguments.iter().map(shape).collect::<Vec<_>>().join(",")
        ),
        Kind::Cases(arms, otherwise) => {
            let arms: Vec<String> = arms
                .iter()
                .map(|(value, condition)| format!("{}?{}", shape(value), shape(condition)))
                .collect();
            format!(
                "[{};{}]",
                arms.join(","),
                otherwise.as_ref().map_or(String::new(), |value| shape(value))
            )
        }
    }
}
