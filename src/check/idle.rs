//! Limits that are not what they seem: they hold, or fail, whatever the values are.

use super::{
    evaluate::{number, words},
    prelude::*,
    values::Values,
};
use crate::catalog::Statistic;
use crate::metrics::rounded;
use crate::result::Reason;

/// Statistics that are never negative, beside those of scatter.
const OF_MAGNITUDES: [&str; 2] = ["rms", "peak"];

impl Checker<'_> {
    /// A difference that does not depend on the two values, such as `measured - measured`.
    pub fn depends_on_values(&mut self, difference: &Expr, at: &Span) -> Option<()> {
        /// Values of both signs, without a simple ratio.
        const TRIED: [(f64, f64); 3] = [(1.0, -1.7), (2.9, 1.0), (-1.7, 2.9)];
        let mut found = TRIED
            .iter()
            .map(|&(simulated, measured)| number(difference, &Pair { simulated, measured }));
        let Some(Ok(first)) = found.next() else { return Some(()) };
        if !found.all(|other| other == Ok(first)) {
            return Some(());
        }
        let says = "this difference is the same whatever the two values are";
        let help = "a difference uses `simulated` and `measured`: `simulated - measured`";
        self.refuse(error("constant-difference", says, at).help(help))
    }

    /// Values that are compared although all of them are taken from the same record: `value
    /// measured(p99.85)`.
    pub fn of_both_records(
        &mut self,
        values: &[Valued],
        difference: &Expr,
        at: &Span,
    ) -> Option<()> {
        let mut sides =
            values.iter().flat_map(|value| value.inputs.iter().flatten()).map(|input| input.side);
        let uses =
            |side: Side| difference.any(&|part| matches!(part.kind, Kind::Side(of) if of == side));
        let first =
            sides.next().filter(|side| *side != InputSide::Own && Side::ALL.into_iter().all(uses));
        let Some(side) = first.filter(|first| sides.all(|side| side == *first)) else {
            return Some(());
        };
        let name = if side == InputSide::Measured { "measured" } else { "simulated" };
        let help = format!("write the value without `{name}(...)`: it is taken from each record");
        self.refuse(problem!("value-of-one-record", at, "this value is taken from the {name} record for both sides, so that the two are always equal").help(help))
    }

    /// A share is at most 1: a limit above it always holds, and with `at least` never. Usually `%`
    /// is missing.
    pub fn share_above_one(&mut self, estimate: &Estimate, bound: &Expr) -> Option<()> {
        let Kind::Constant(Scalar::Number(value)) = bound.kind else { return Some(()) };
        if value <= 1.0 || !is_share(estimate) {
            return Some(());
        }
        let help = (value <= 100.0).then(|| format!("write `{} %`", rounded(value)));
        self.refuse(
            problem!("out-of-range", bound, "a share is at most 1; `{}` is above it", words(bound))
                .help_if(help),
        )
    }

    /// The estimate of a whole quantity with a bound from the same values: the two grow together.
    pub fn of_own_values(&mut self, estimate: &Estimate, bound: &OfGroup, block: &Block) {
        let own = |taking: &Taking| match taking {
            Taking::Other { id, .. } => id == block.name_text(),
            Taking::Data { of_rows, .. } => *of_rows,
            Taking::Statistic(..) | Taking::Weighted { .. } => true,
            _ => false,
        };
        if matches!(estimate.kind, EstimateKind::Each) || !bound.taken.iter().any(own) {
            return;
        }
        let says = format!(
            "this bound is taken from the values of `{}`, which it limits",
            block.name_text()
        );
        let help = "it says nothing about their size; name another quantity, or write a number";
        self.tell(warning("own-values", says, &bound.expr.span).help(help));
    }

    /// `mean + 3 * std` of differences: its magnitude is small where the mean is negative, so a bad
    /// model can pass.
    pub fn signed_estimate(&mut self, estimate: &Estimate, at: &impl Located) {
        let EstimateKind::Of(of) = &estimate.kind else { return };
        let Kind::Binary(Operator::Add, left, right) = &of.expr.kind else { return };
        let (mut signed, mut scatter) = (false, false);
        for part in [left, right] {
            let mut named = Vec::new();
            outside_magnitudes(part, &mut named);
            let statistics = named.into_iter().filter_map(|index| match of.taken.get(index) {
                Some(Taking::Statistic(statistic, _) | Taking::Weighted { statistic, .. }) => {
                    Some(*statistic)
                }
                _ => None,
            });
            for statistic in statistics {
                let magnitude = matches!(statistic, Statistic::Named(entry) if OF_MAGNITUDES.contains(&entry.name));
                scatter |= statistic.of_scatter();
                signed |= !statistic.of_scatter() && !magnitude;
            }
        }
        if signed && scatter {
            let says = "the magnitude of this estimate is small where the differences are negative on average";
            let help = "write it with the magnitude of the mean: `(|mean| + 3 * std)`";
            // A limit for each zone is checked once for each.
            let told = |problem: &Problem| {
                problem.code == "signed-estimate" && problem.at.as_ref() == Some(&at.place())
            };
            if !self.problems.0.iter().any(told) {
                self.tell(warning("signed-estimate", says, at).help(help));
            }
        }
    }
}

/// A pair of values; nothing else is known.
pub struct Pair {
    pub simulated: f64,
    pub measured: f64,
}

impl Values for Pair {
    fn sides(&self) -> Result<(f64, f64), Reason> {
        Ok((self.simulated, self.measured))
    }
}

/// Whether the estimate is a share, or an end of its confidence interval.
fn is_share(estimate: &Estimate) -> bool {
    let EstimateKind::Of(of) = &estimate.kind else { return false };
    match (&of.expr.kind, &of.taken[..]) {
        (Kind::Input(0), [Taking::Where { share, .. }]) => *share,
        (Kind::Input(0), [Taking::Bound { of, .. }]) => is_share(of),
        _ => false,
    }
}

/// The inputs of an expression that are not inside `|...|`.
fn outside_magnitudes(expr: &Expr, found: &mut Vec<usize>) {
    match &expr.kind {
        Kind::Input(index) => found.push(*index),
        Kind::Call(function, _) if function.name == "magnitude" => {}
        Kind::Cases(..) => {}
        _ => expr.parts().into_iter().for_each(|part| outside_magnitudes(part, found)),
    }
}
