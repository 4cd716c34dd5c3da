//! What is done with the problems once all is checked, and the count of the rules.

use std::collections::BTreeSet;

use super::{Overrides, names::Names, prelude::*};
use crate::catalog::{Reducer, Statistic};

/// Better help where the unknown unit after a number is a name, which the parser does not know: `3
/// std`.
pub fn name_after_number(problem: &mut Problem, names: &Names) {
    let Some(word) = problem.at.as_ref().filter(|_| problem.code == "unknown-unit").map(Span::text)
    else {
        return;
    };
    let is_name = Reducer::named(word).is_some()
        || Statistic::named(word).is_some()
        || names.parameter_blocks.contains_key(word)
        || names.defines.contains_key(word)
        || names.estimates.contains_key(word)
        || names.vehicle.iter().chain(&names.columns).any(|datum| datum.name == word);
    if is_name && problem.near.take().is_some() {
        problem.help = Some(format!("a product is written with its sign: `... * {word}`"));
    }
}

/// Problems of a value; others do not depend on what a parameter is set to.
const OF_VALUES: [&str; 2] = ["not-a-count", "out-of-range"];

/// Where the text of a wrong value names a parameter set from outside the protocol, the place where
/// it was set.
pub fn set_outside(problem: &mut Problem, overrides: &Overrides) {
    let Some(at) = problem.at.as_ref().filter(|_| OF_VALUES.contains(&problem.code)) else {
        return;
    };
    let named: BTreeSet<&str> =
        at.text().split(|c: char| !c.is_alphanumeric() && c != '_').collect();
    let given = overrides
        .iter()
        .filter(|(name, given)| named.contains(name.as_str()) && given.text.span != *at);
    problem.also.extend(given.map(|(_, given)| (given.text.span.clone(), "set here".to_owned())));
}

/// Sorts the problems from the given index on by their places, text by text.
pub fn in_reading_order(problems: &mut Problems, from: usize) {
    let mut sources: Vec<String> = Vec::new();
    for problem in &problems.0[from..] {
        if let Some(at) = problem.at.as_ref().filter(|at| !sources.contains(&at.source.name)) {
            sources.push(at.source.name.clone());
        }
    }
    let place = |problem: &Problem| {
        problem
            .at
            .as_ref()
            .map(|at| (sources.iter().position(|name| *name == at.source.name), at.start))
    };
    problems.0[from..].sort_by_key(place);
}

pub fn written_rules(block: &Block) -> usize {
    match block.kind.text.as_str() {
        "zone" | "check" | "filter" | "domain" | "plausibility" => 1,
        "quantity" => {
            1 + block.fields_named("limit").count() + block.fields_named("report").count()
        }
        "sections" => block.fields_named("report").count(),
        "verdict" => usize::from(block.name.is_some()),
        _ => 0,
    }
}

pub fn rule_count(plan: &Plan) -> usize {
    // One for each zone is written once.
    fn written<'a>(spans: impl Iterator<Item = &'a Span>) -> usize {
        let mut written: Vec<&Span> = spans.collect();
        written.dedup();
        written.len()
    }
    let of_quantity = |quantity: &Quantity| {
        1 + written(quantity.limits.iter().map(|limit| &limit.span))
            + written(quantity.reports.iter().map(|report| &report.span))
    };
    plan.zones.len()
        + plan.checks.len()
        // One for each `of`; of `every channel`, one for each channel.
        + plan.plausibility.iter().map(|rule| &rule.name).collect::<BTreeSet<_>>().len()
        + plan.filters.len()
        + plan.domains.len()
        + plan.verdicts.iter().filter(|verdict| verdict.name.is_some()).count()
        + written(plan.sections.reports.iter().map(|report| &report.span))
        + plan.quantities.iter().map(of_quantity).sum::<usize>()
}
