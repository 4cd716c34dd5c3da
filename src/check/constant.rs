//! Values that are the same whatever the records are: `0 * correlation`.

use super::{
    evaluate::number,
    prelude::*,
    values::{Nothing, Values},
};
use crate::metrics::rounded;
use crate::result::Reason;

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
    fn vehicle(&self, index: usize) -> Result<Scalar, Reason> {
        self.values.vehicle(index)
    }
    fn column(&self, index: usize) -> Result<Scalar, Reason> {
        self.values.column(index)
    }
    fn extent(&self) -> Result<(f64, f64), Reason> {
        self.values.extent()
    }
    fn input(&self, index: usize) -> Result<f64, Reason> {
        Ok(tried(self.set, self.alike.get(index).copied().unwrap_or(index)))
    }
    fn sides(&self) -> Result<(f64, f64), Reason> {
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
    expr.any(&|part| matches!(part.kind, Kind::Input(_) | Kind::Side(_)))
}

/// Whether a value of the records decides between others.
fn has_steps(expr: &Expr) -> bool {
    expr.any(&|part| match &part.kind {
        Kind::Cases(arms, _) => arms.iter().any(|(_, condition)| of_records(condition)),
        Kind::Call(function, arguments) => {
            WITH_STEPS.contains(&function.name) && arguments.iter().any(of_records)
        }
        _ => false,
    })
}

impl Checker<'_> {
    /// A metric, or a value (`what`), that no record can change.
    pub fn can_vary(
        &mut self,
        what: &str,
        expr: &Expr,
        inputs: &[Input],
        at: &impl Located,
    ) -> Option<()> {
        let code = "constant-value";
        let help = if what == "metric" {
            "a metric uses metrics or the samples of both sides: `correlation`, `rms of (simulated - measured)`"
        } else {
            "a value is taken from the signal: `median`, `p99.85`"
        };
        for input in inputs {
            let (Taken::OfBoth(_), Some(signal)) = (input.taken, &input.signal) else { continue };
            if whatever_the_records(signal, &[], &Nothing).is_some() {
                return self.refuse(
                    error(
                        code,
                        format!(
                            "all samples of `{}` are the same whatever the records are",
                            normalised(signal.span.text())
                        ),
                        &input.span,
                    )
                    .help(help),
                );
            }
        }
        let Some(value) = whatever_the_records(expr, inputs, &Nothing) else { return Some(()) };
        self.refuse(
            error(code, format!("this {what} is {} whatever the records are", rounded(value)), at)
                .help(help),
        )
    }
}
