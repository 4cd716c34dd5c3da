//! Values that are the same whatever the records are: `0 * correlation`.

use super::Checker;
use super::evaluate::number;
use super::names::normalised;
use super::plan::{
    Expr, Input, InputSide, Kind, Operator, Scalar, Side, Signal, SignalKind, Taken,
};
use super::values::{Nothing, Values};
use crate::catalog::Function;
use crate::metrics::rounded;
use crate::problem::Problem;
use crate::source::Span;

/// Number of sets of inputs that are tried. Arithmetic that gives the same for three sets without a
/// simple ratio is the same for all.
const SETS: usize = 3;
/// What results may differ by and still be the same: rounding.
const SAME: f64 = 1e-12;
/// Functions with steps or with values that only one argument decides: numbers that are tried may
/// all lie on one side.
const WITH_STEPS: [&str; 4] = ["larger", "smaller", "floor", "sign"];

/// Irregular numbers between 0 and 1, which every function is defined for.
fn tried(set: usize, input: usize) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    0.05 + 0.9 * (GOLDEN * (1 + input + 7 * set) as f64 + 0.37 * set as f64).fract()
}

/// Names with their values, and inputs of one set.
struct Trial<'a> {
    values: &'a dyn Values,
    /// For each input the first that is the same.
    alike: &'a [usize],
    set: usize,
}

impl Values for Trial<'_> {
    fn vehicle(&self, index: usize) -> Result<Scalar, String> {
        self.values.vehicle(index)
    }
    fn column(&self, index: usize) -> Result<Scalar, String> {
        self.values.column(index)
    }
    fn extent(&self) -> Result<(f64, f64), String> {
        self.values.extent()
    }
    fn input(&self, index: usize) -> Result<f64, String> {
        Ok(tried(self.set, self.alike.get(index).copied().unwrap_or(index)))
    }
    fn sides(&self) -> Result<(f64, f64), String> {
        Ok((tried(self.set, 0), tried(self.set, 1)))
    }
}

/// The value that an expression has whatever its inputs and the two compared values are, with these
/// values of other names. `None` where they matter, and where it cannot be told. `inputs` are those
/// of one position.
pub fn whatever_the_records(expr: &Expr, inputs: &[Input], values: &dyn Values) -> Option<f64> {
    if has_steps(expr) {
        return None;
    }
    // `simulated(std)` and `measured(std)` are both written `std`.
    let names: Vec<(String, InputSide)> =
        inputs.iter().map(|input| (normalised(input.span.text()), input.side)).collect();
    let alike: Vec<usize> = names
        .iter()
        .map(|name| names.iter().position(|known| known == name).unwrap_or_default())
        .collect();
    same((0..SETS).map(|set| number(expr, &Trial { values, alike: &alike, set }).ok()))
}

/// The number that all are, if there is one.
fn same(mut all: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let first = all.next()??;
    let close =
        |other: Option<f64>| other.is_some_and(|other| (other - first).abs() <= SAME * first.abs());
    (first.is_finite() && all.all(close)).then_some(first)
}

fn of_records(expr: &Expr) -> bool {
    let mut any = false;
    expr.visit(&mut |part| {
        any |= matches!(part.kind, Kind::Input(_) | Kind::Simulated | Kind::Measured)
    });
    any
}

/// Whether a value of the records decides between others.
fn has_steps(expr: &Expr) -> bool {
    let mut any = false;
    expr.visit(&mut |part| {
        any |= match &part.kind {
            Kind::Cases(arms, _) => arms.iter().any(|(_, condition)| of_records(condition)),
            Kind::Call(function, arguments) => {
                WITH_STEPS.contains(&function.name) && arguments.iter().any(of_records)
            }
            _ => false,
        };
    });
    any
}

/// A sample of a signal of both sides, from a sample of each; `None` where it takes more than that.
fn sample(signal: &Signal, sides: (f64, f64)) -> Option<f64> {
    let of = |inner: &Signal| sample(inner, sides);
    let stepless = |function: &&'static Function| !WITH_STEPS.contains(&function.name);
    match &signal.kind {
        SignalKind::Side(Side::Simulated) => Some(sides.0),
        SignalKind::Side(Side::Measured) => Some(sides.1),
        SignalKind::Scalar(expr) => number(expr, &Nothing).ok(),
        SignalKind::Negative(inner) => Some(-of(inner)?),
        SignalKind::Power(inner, exponent) => Some(of(inner)?.powi(i32::from(*exponent))),
        SignalKind::Call(function, arguments) => {
            let function = Some(function).filter(|function| stepless(function))?;
            Some((function.run)(&arguments.iter().map(of).collect::<Option<Vec<_>>>()?))
        }
        SignalKind::Binary(operator, left, right) => {
            let (left, right) = (of(left)?, of(right)?);
            match operator {
                Operator::Add => Some(left + right),
                Operator::Subtract => Some(left - right),
                Operator::Multiply => Some(left * right),
                Operator::Divide => Some(left / right),
                _ => None,
            }
        }
        _ => None,
    }
}

impl Checker<'_> {
    /// A metric, or a value (`what`), that no record can change.
    pub(super) fn can_vary(
        &mut self,
        what: &str,
        expr: &Expr,
        inputs: &[Input],
        at: &Span,
    ) -> Option<()> {
        let code = "constant-value";
        let help = if what == "metric" {
            "a metric uses metrics or the samples of both sides: `correlation`, `rms of (simulated - measured)`"
        } else {
            "a value is taken from the signal: `median`, `p99.85`"
        };
        for input in inputs {
            let (Taken::OfBoth(_), Some(signal)) = (input.taken, &input.signal) else { continue };
            let samples = (0..SETS).map(|set| sample(signal, (tried(set, 0), tried(set, 1))));
            if same(samples).is_some() {
                let says = format!(
                    "all samples of `{}` are the same whatever the records are",
                    normalised(signal.span.text())
                );
                self.problems.push(Problem::error(code, says).at(&input.span).help(help));
                return None;
            }
        }
        let Some(value) = whatever_the_records(expr, inputs, &Nothing) else { return Some(()) };
        let says = format!("this {what} is {} whatever the records are", rounded(value));
        self.problems.push(Problem::error(code, says).at(at).help(help));
        None
    }
}
