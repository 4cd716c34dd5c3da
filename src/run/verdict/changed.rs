//! How far limits are from changing the overall verdict: from the estimates and their limits alone.

use super::judge::Judged;
use super::verdicts::{Given, decide};
use crate::check::plan::{Decision, Plan};
use crate::result::{Direction, EdgeResult, QuantityResult, Reason, Verdict};

/// A limit, or all of them, and the factors at which the verdict changes.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitChange {
    /// `std of Y_qst`; `None` of all limits together.
    pub of: Option<String>,
    /// Factors below and above 1 at which the verdict changes; `None` where it does not.
    pub low: Option<Flip>,
    pub high: Option<Flip>,
}

/// A factor of a limit, and the verdict that it leads to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flip {
    pub factor: f64,
    pub verdict: Verdict,
}

/// A statistic of the overall verdict: its quantity, its index there, and the factor of its limit
/// at which it is met just so.
struct Edge {
    quantity: usize,
    statistic: usize,
    factor: f64,
    /// Whether a larger limit is easier to meet.
    upper: bool,
    /// Of a limit between two edges, whether the other one is met.
    other: Option<bool>,
}

/// The changes of each limit of the overall verdict, and of all together. A verdict that is not
/// assessable does not change with limits.
pub fn limit_changes(plan: &Plan, judged: &Judged) -> Vec<LimitChange> {
    let Decision::Limits { quantities, draws: None, .. } = &plan.overall().decision else {
        return Vec::new();
    };
    if judged.verdict == Verdict::NotAssessable {
        return Vec::new();
    }
    let bare: Vec<QuantityResult> = judged
        .quantities
        .iter()
        .map(|quantity| QuantityResult { values: Vec::new(), ..quantity.clone() })
        .collect();
    let mut lines: Vec<(String, Vec<Edge>)> = Vec::new();
    for &index in quantities {
        for (at, statistic) in bare[index].statistics.iter().enumerate() {
            let compared = statistic.compared();
            for (nth, one) in compared.iter().enumerate() {
                let Some(factor) = factor(one) else { continue };
                let upper = one.limit.is_none_or(|limit| limit > 0.0)
                    != (one.direction == Direction::AtLeast);
                let other = compared.iter().rev().nth(nth).filter(|_| compared.len() > 1);
                let other = other.and_then(|other| other.holds);
                let edge = Edge { quantity: index, statistic: at, factor, upper, other };
                let which = other.map_or("", |_| [", lower edge", ", upper edge"][nth]);
                let name = format!("{} of {}{which}", statistic.name, bare[index].id);
                let same = |other: &Edge| {
                    other.quantity == index
                        && bare[index].statistics[other.statistic].rule.line == statistic.rule.line
                };
                // The groups of a limit have it in common.
                let known = lines.iter_mut().rev().take(compared.len());
                match known.into_iter().find(|(known, edges)| *known == name && same(&edges[0])) {
                    Some((_, edges)) => edges.push(edge),
                    None => lines.push((name, vec![edge])),
                }
            }
        }
    }
    let change = |of: Option<String>, edges: &[&Edge]| {
        let [low, high] = flips(plan, (&bare, judged.verdict), edges);
        LimitChange { of, low, high }
    };
    let all: Vec<&Edge> = lines.iter().flat_map(|(_, edges)| edges).collect();
    let together = change(None, &all);
    let each = lines
        .iter()
        .map(|(name, edges)| change(Some(name.clone()), &edges.iter().collect::<Vec<_>>()));
    std::iter::once(together).chain(each).collect()
}

/// The factor of the limit at which the value is at it.
fn factor(compared: &EdgeResult) -> Option<f64> {
    compared.holds?;
    let share = || Some(compared.value? / compared.limit?);
    let factor = match compared.direction {
        Direction::Magnitude => compared.normalised?,
        Direction::AtMost | Direction::AtLeast => share()?,
    };
    (factor.is_finite() && factor > 0.0).then_some(factor)
}

/// The nearest factors on both sides of 1 at which the verdict is another one. It can change only
/// where some statistic meets its limit just so.
fn flips(
    plan: &Plan,
    (bare, verdict): (&[QuantityResult], Verdict),
    edges: &[&Edge],
) -> [Option<Flip>; 2] {
    let at = |side: f64| {
        let mut factors: Vec<f64> = edges.iter().map(|edge| edge.factor).collect();
        factors.retain(|factor| side * (factor - 1.0) >= 0.0);
        factors.sort_by(|a, b| (side * a).total_cmp(&(side * b)));
        factors.into_iter().find_map(|factor| {
            let found = decided(plan, bare, edges, (factor, side));
            (found != verdict).then_some(Flip { factor, verdict: found })
        })
    };
    [at(-1.0), at(1.0)]
}

/// The verdict with limits times a factor, just beyond it on one side. A value at its limit meets
/// it.
fn decided(
    plan: &Plan,
    bare: &[QuantityResult],
    edges: &[&Edge],
    (factor, side): (f64, f64),
) -> Verdict {
    let mut quantities = bare.to_vec();
    for edge in edges {
        quantities[edge.quantity].statistics[edge.statistic].holds = Some(true);
    }
    for edge in edges {
        let beyond = side * (factor - edge.factor) >= 0.0;
        // A larger limit is met by what has its edge below the factor.
        let met = match (edge.upper, side > 0.0) {
            (true, true) | (false, false) => beyond,
            (true, false) | (false, true) => !beyond,
        };
        let beside = |other: &&Edge| {
            !std::ptr::eq(*other, *edge)
                && (other.quantity, other.statistic) == (edge.quantity, edge.statistic)
        };
        let other = edge.other.is_none_or(|met| met || edges.iter().any(beside));
        if !(met && other) {
            quantities[edge.quantity].statistics[edge.statistic].holds = Some(false);
        }
    }
    let fails: Vec<Vec<Reason>> = quantities
        .iter_mut()
        .map(|quantity| {
            let failing = quantity.statistics.iter().filter(|one| one.holds == Some(false));
            let fails = vec![Reason::NoVerdict; failing.count()];
            if quantity.holds.is_some() {
                quantity.holds = Some(fails.is_empty());
            }
            fails
        })
        .collect();
    let given = Given { barred: Vec::new(), quantities: &quantities, fails, sample: None };
    decide(plan, &given).first().map_or(Verdict::NotAssessable, |first| first.outcome.overall())
}
