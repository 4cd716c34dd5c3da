//! Section checks of the protocol, on the track record or on the records of both sides.

use super::plausibility::Questions;
use crate::result::{CheckResult, Datum};
use crate::run::{
    prelude::*,
    record::{Fault, SectionWork, Work},
    sections::{Known, requirements::met},
    values::{NodeValues, SectionValues, Sides, Two},
};
use crate::units::Dimension;
use crate::words::digits;

/// Significant digits of a value found.
const DIGITS: usize = 4;

/// Checks that use the track record; without one their result is "not checked". Returns the values
/// of the track record.
///
/// # Errors
/// The track record cannot be read.
pub fn track_checks(
    section: &SectionWork<'_>,
    questions: &Questions<'_>,
    values: &mut SectionValues,
) -> Result<NodeValues, Fault> {
    let (graph, campaign) = (section.work.graph, section.campaign());
    let mut wanted = questions.wanted(graph, None);
    let of_checks = section.checks().filter(|(_, absent)| absent.is_none());
    let of_checks = of_checks.flat_map(|((_, inputs), _)| inputs.iter().map(|input| input.node));
    wanted.extend(of_checks.filter(|&node| graph.nodes[node].track));
    let there = || match campaign.record_source(RecordKind::Track, &section.unit.cell) {
        Ok(_) => Ok(true),
        // A missing track record is stated for each check; a track record that cannot be read is a
        // fault.
        Err(problem) if problem.code == "file-unreadable" => {
            Err(Fault::new(Reason::Unreadable { says: problem.says }))
        }
        Err(_) => Ok(false),
    };
    let found = if !wanted.is_empty() && campaign.has(RecordKind::Track) && there()? {
        section.record(RecordKind::Track.into(), &wanted, values)?.found
    } else {
        NodeValues::NONE
    };
    for ((check, inputs), absent) in section.checks() {
        let result = if let Some(absent) = absent {
            result(check, (None, Reason::NotChecked { reason: Box::new(absent) }))
        } else if of_records(graph, inputs) {
            // Replaced after both records are evaluated.
            result(check, (None, Reason::RecordsNotEvaluated))
        } else {
            let value = |input: &InputNode| {
                found.number(input.node).map(|(value, _)| value).map_err(|_| Reason::NoTrackRecord)
            };
            checked(section, check, &inputs.iter().map(value).collect::<Vec<_>>())
        };
        values.checks.push(result);
    }
    Ok(found)
}

/// Whether a check uses the records of a side.
fn of_records(graph: &Graph, inputs: &[InputNode]) -> bool {
    inputs.iter().any(|input| !graph.nodes[input.node].track)
}

/// With several records, the first that does not meet a check decides.
pub fn record_checks(sides: &Sides<'_>, values: &mut SectionValues) {
    let Work { plan, graph, .. } = *sides.section.work;
    let side = if plan.reads(Side::Measured) { InputSide::Measured } else { InputSide::Simulated };
    for (index, ((check, inputs), absent)) in sides.section.checks().enumerate() {
        if absent.is_some() || !of_records(graph, inputs) {
            continue;
        }
        let of_pair = |(record, two): (Option<RecordName>, Two<'_>)| {
            let inputs: Vec<_> = inputs.iter().map(|input| two.input(input, side)).collect();
            let mut found = checked(sides.section, check, &inputs);
            if let Some(name) = record {
                found.says = found.says.about(Subject::Record, name.to_string());
            }
            found
        };
        // Of equal ones the first.
        let worst = sides.pairs().map(of_pair).min_by_key(|found| match found.holds {
            Some(false) => 0,
            None => 1,
            Some(true) => 2,
        });
        if let Some(worst) = worst {
            values.checks[index] = worst;
        }
    }
}

fn result(check: &Check, (holds, says): (Option<bool>, Reason)) -> CheckResult {
    CheckResult { name: check.name.clone(), title: check.title.clone(), holds, says }
}

fn checked(
    section: &SectionWork<'_>,
    check: &Check,
    inputs: &[Result<f64, Reason>],
) -> CheckResult {
    let known = &section.known;
    let spared = check.unless.as_ref().map_or(Ok(false), |unless| flag(unless, known));
    let found = match spared {
        Ok(true) => (Some(true), Reason::DoesNotApply),
        Err(reason) => (None, reason),
        Ok(false) => {
            let holds = flag(&check.require, &Known { inputs, ..*known });
            met(holds, &check.words, || found_values(section.work.plan, check, inputs))
        }
    };
    result(check, found)
}

/// The values found: range of curvature 0.00021 1/m, mean of curvature 0.002 1/m.
fn found_values(plan: &Plan, check: &Check, inputs: &[Result<f64, Reason>]) -> Vec<Datum> {
    let one = |(input, value): (&Input, &Result<f64, Reason>)| {
        let value = digits(*value.as_ref().ok()?, DIGITS).to_string();
        let signal = input.signal.as_ref()?;
        let dimension = input.taken.gives(signal.dimension(), plan.axis.unit.dimension);
        let unit = (dimension != Dimension::ONE).then(|| dimension.to_string());
        let name = input.span.text().split_whitespace().collect::<Vec<_>>().join(" ");
        Some(Datum { name, value, unit })
    };
    check.inputs.iter().zip(inputs).filter_map(one).collect()
}
