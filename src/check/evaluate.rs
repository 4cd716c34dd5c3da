//! Evaluates a checked expression, given the values of its names.

use std::cell::RefCell;

use super::plan::{Expr, Kind, Operator, Scalar};
use super::possible::possible;

/// Values of the names in an expression. Each method may return an error that states why the value is missing; by default it is
/// missing.
pub trait Values {
    fn vehicle(&self, _: usize) -> Result<Scalar, String> {
        Err("vehicle data are not known here".into())
    }
    fn column(&self, _: usize) -> Result<Scalar, String> {
        Err("section data are not known here".into())
    }
    /// Start and end of the section on the axis, SI.
    fn extent(&self) -> Result<(f64, f64), String> {
        Err("there is no section here".into())
    }
    fn input(&self, _: usize) -> Result<f64, String> {
        Err("there is no signal here".into())
    }
    /// Simulated and measured value of a pair, in this order.
    fn sides(&self) -> Result<(f64, f64), String> {
        Err("there is no pair of values here".into())
    }
    fn limit_of(&self, statistic: &str) -> Result<f64, String> {
        Err(format!("the limit of {statistic} is not known here"))
    }
    /// By what share of the right side `<=` and `>=` may be missed: the rounding of numbers that were converted to SI and subtracted.
    fn rounding(&self) -> f64 {
        0.0
    }
}

/// No name has a value: only constants can be evaluated.
#[derive(Clone, Copy, Debug)]
pub struct Nothing;

impl Values for Nothing {}

/// Passes values on and records which section columns were used.
#[derive(Debug)]
pub struct Watched<'a, V: Values> {
    values: &'a V,
    columns: RefCell<Vec<usize>>,
}

impl<'a, V: Values> Watched<'a, V> {
    pub fn new(values: &'a V) -> Self {
        Self { values, columns: RefCell::default() }
    }

    /// Indices of the columns used, in the order of first use.
    pub fn columns(&self) -> Vec<usize> {
        self.columns.borrow().clone()
    }
}

impl<V: Values> Values for Watched<'_, V> {
    fn vehicle(&self, index: usize) -> Result<Scalar, String> {
        self.values.vehicle(index)
    }
    fn column(&self, index: usize) -> Result<Scalar, String> {
        let mut columns = self.columns.borrow_mut();
        if !columns.contains(&index) {
            columns.push(index);
        }
        self.values.column(index)
    }
    fn extent(&self) -> Result<(f64, f64), String> {
        self.values.extent()
    }
    fn input(&self, index: usize) -> Result<f64, String> {
        self.values.input(index)
    }
    fn sides(&self) -> Result<(f64, f64), String> {
        self.values.sides()
    }
    fn limit_of(&self, statistic: &str) -> Result<f64, String> {
        self.values.limit_of(statistic)
    }
    fn rounding(&self) -> f64 {
        self.values.rounding()
    }
}

/// The value of an expression. Where names have no value, the result is the value that the expression has for every value of them,
/// if there is one.
///
/// # Errors
/// The name that has no value, or the operation that is not defined (such as a division by zero).
pub fn evaluate(expr: &Expr, values: &dyn Values) -> Result<Scalar, String> {
    match exactly(expr, values) {
        // The other operands cannot decide a leaf without a value.
        Err(reason) if matches!(expr.kind, Kind::Binary(..) | Kind::Not(_) | Kind::Cases(..)) => possible(expr, values).one().ok_or(reason),
        found => found,
    }
}

fn exactly(expr: &Expr, values: &dyn Values) -> Result<Scalar, String> {
    let result = match &expr.kind {
        Kind::Constant(value) => value.clone(),
        Kind::Vehicle(index) => values.vehicle(*index)?,
        Kind::Column(index) => values.column(*index)?,
        Kind::Start => Scalar::Number(values.extent()?.0),
        Kind::End => Scalar::Number(values.extent()?.1),
        Kind::Input(index) => Scalar::Number(values.input(*index)?),
        Kind::Simulated => Scalar::Number(values.sides()?.0),
        Kind::Measured => Scalar::Number(values.sides()?.1),
        Kind::LimitOf(statistic) => Scalar::Number(values.limit_of(statistic)?),
        Kind::Negative(inner) => Scalar::Number(-number(inner, values)?),
        Kind::Not(inner) => Scalar::Flag(!flag(inner, values)?),
        Kind::Power(inner, exponent) => Scalar::Number(number(inner, values)?.powi(i32::from(*exponent))),
        Kind::Binary(operator, left, right) => binary(*operator, left, right, values)?,
        Kind::Call(function, arguments) => {
            let arguments = arguments.iter().map(|argument| number(argument, values)).collect::<Result<Vec<_>, _>>()?;
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
    };
    match result {
        Scalar::Number(value) if !value.is_finite() => Err(format!("`{}` is not a finite number", words(expr))),
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

fn binary(operator: Operator, left: &Expr, right: &Expr, values: &dyn Values) -> Result<Scalar, String> {
    Ok(match operator {
        // If one side decides the result, the other may be missing: `direction is straight or radius > 600 m`.
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

/// The structure of an expression without its place in the source. Two expressions with the same structure always have the same
/// value.
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
        Kind::Binary(operator, left, right) => format!("{operator:?}({},{})", shape(left), shape(right)),
        Kind::Call(function, arguments) => format!("{}({})", function.name, arguments.iter().map(shape).collect::<Vec<_>>().join(",")),
        Kind::Cases(arms, otherwise) => {
            let arms: Vec<String> = arms.iter().map(|(value, condition)| format!("{}?{}", shape(value), shape(condition))).collect();
            format!("[{};{}]", arms.join(","), otherwise.as_ref().map_or(String::new(), |value| shape(value)))
        }
    }
}
