//! Section checks of the protocol, on the track record or on the records of both sides.

use std::collections::BTreeSet;

use super::plausibility::Questions;
use crate::check::evaluate::flag;
use crate::check::plan::{Check, Input, InputSide, Side};
use crate::data::RecordKind;
use crate::graph::{InputNode, NodeId};
use crate::result::{CheckResult, RecordName};
use crate::run::record::{Fault, Work};
use crate::run::sections::{Known, Unit};
use crate::run::values::{NodeValues, SectionValues, Sides, Two, one_record};
use crate::units::Dimension;

/// Checks that use the track record; without one their result is "not checked". Returns the values
/// of the track record.
pub fn track_checks(
    work: &Work<'_>,
    unit: &Unit,
    questions: &Questions<'_>,
    known: &Known<'_>,
    values: &mut SectionValues,
) -> Result<NodeValues, Fault> {
    let mut wanted: BTreeSet<NodeId> = work
        .graph
        .checks
        .iter()
        .flatten()
        .map(|input| input.node)
        .filter(|&node| work.graph.nodes[node].track)
        .collect();
    wanted.extend(questions.wanted(work, true));
    let campaign = work.campaign(unit);
    let there = || match campaign.record_source(RecordKind::Track, &unit.cell) {
        Ok(_) => Ok(true),
        // A missing track record is stated for each check; a track record that cannot be read is a
        // fault.
        Err(problem) if problem.code == "file-unreadable" => Err(Fault::new(problem.says)),
        Err(_) => Ok(false),
    };
    let found = if !wanted.is_empty() && campaign.has(RecordKind::Track) && there()? {
        one_record(work, unit, RecordKind::Track.into(), &wanted, known, values)?.found
    } else {
        NodeValues::default()
    };
    for (check, inputs) in work.plan.checks.iter().zip(&work.graph.checks) {
        if !inputs.is_empty() && !inputs.iter().all(|input| work.graph.nodes[input.node].track) {
            // Replaced after both records are evaluated.
            let says = "not checked: the records could not be evaluated".into();
            values.checks.push(CheckResult {
                name: check.name.clone(),
                title: check.title.clone(),
                holds: None,
                says,
            });
            continue;
        }
        let value = |input: &InputNode| {
            found
                .number(input.node)
                .map(|(value, _)| value)
                .map_err(|_| "not checked: there is no track record".to_string())
        };
        let inputs: Vec<Result<f64, String>> = inputs.iter().map(value).collect();
        values.checks.push(checked(work, check, known, &inputs));
    }
    Ok(found)
}

/// With several records, the first that does not meet a check decides.
pub fn record_checks(sides: &Sides<'_>, values: &mut SectionValues) {
    let work = sides.work;
    let side = if work.reads(Side::Measured) { InputSide::Measured } else { InputSide::Simulated };
    for (index, (check, inputs)) in work.plan.checks.iter().zip(&work.graph.checks).enumerate() {
        if inputs.is_empty() || inputs.iter().all(|input| work.graph.nodes[input.node].track) {
            continue;
        }
        let of_pair = |(record, two): (Option<RecordName>, Two<'_>)| {
            let inputs: Vec<Result<f64, String>> =
                inputs.iter().map(|input| two.input(input, side)).collect();
            let found = checked(work, check, two.known, &inputs);
            CheckResult {
                says: record
                    .map_or_else(|| found.says.clone(), |name| format!("{name}: {}", found.says)),
                ..found
            }
        };
        let mut found: Vec<CheckResult> = sides.pairs().map(of_pair).collect();
        found.sort_by_key(|one| one.holds.map_or(1, |holds| if holds { 2 } else { 0 }));
        if let Some(worst) = found.into_iter().next() {
            values.checks[index] = worst;
        }
    }
}

fn checked(
    work: &Work<'_>,
    check: &Check,
    known: &Known<'_>,
    inputs: &[Result<f64, String>],
) -> CheckResult {
    let result = |holds: Option<bool>, says: String| CheckResult {
        name: check.name.clone(),
        title: check.title.clone(),
        holds,
        says,
    };
    let spared = check.unless.as_ref().map_or(Ok(false), |unless| flag(unless, known));
    match spared {
        Ok(true) => return result(Some(true), "does not apply to this section".into()),
        Err(reason) => return result(None, reason),
        Ok(false) => {}
    }
    match flag(&check.require, &Known { inputs, ..*known }) {
        Ok(true) => {
            result(Some(true), format!("{}{}", check.words, found_values(work, check, inputs)))
        }
        Ok(false) => result(
            Some(false),
            format!("not met: {}{}", check.words, found_values(work, check, inputs)),
        ),
        Err(reason) => result(None, reason),
    }
}

/// The values found, as text: `; found: range of curvature 0.00021 1/m, mean of curvature 0.002
/// 1/m`.
fn found_values(work: &Work<'_>, check: &Check, inputs: &[Result<f64, String>]) -> String {
    let one = |(input, value): (&Input, &Result<f64, String>)| {
        let value: f64 = format!("{:.3e}", value.as_ref().ok()?).parse().ok()?;
        let signal = input.signal.as_ref()?;
        let dimension = input.taken.gives(signal.dimension(), work.plan.axis.unit.dimension);
        let unit =
            if dimension == Dimension::ONE { String::new() } else { format!(" {dimension}") };
        let words = input.span.text().split_whitespace().collect::<Vec<_>>().join(" ");
        Some(format!("{words} {value}{unit}"))
    };
    let found = check.inputs.iter().zip(inputs).filter_map(one).collect::<Vec<_>>().join(", ");
    if found.is_empty() { found } else { format!("; found: {found}") }
}
