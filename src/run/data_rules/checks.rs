//! Section checks of the protocol, on the track record or on the records of both sides.

use std::collections::BTreeSet;

use super::plausibility::Questions;
use crate::check::evaluate::flag;
use crate::check::plan::{Check, Input, InputSide, Side};
use crate::data::RecordKind;
use crate::graph::{InputNode, NodeId};
use crate::result::{CheckResult, Datum, Reason, RecordName, Subject};
use crate::run::record::{Fault, Work};
use crate::run::sections::requirements::met;
use crate::run::sections::{Known, Unit};
use crate::run::values::{NodeValues, SectionValues, Sides, Two, one_record};
use crate::units::Dimension;
use crate::words::digits;

/// Significant digits of a value found.
const DIGITS: usize = 4;

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
        Err(problem) if problem.code == "file-unreadable" => {
            Err(Fault::new(Reason::Unreadable { says: problem.says }))
        }
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
            values.checks.push(CheckResult {
                name: check.name.clone(),
                title: check.title.clone(),
                holds: None,
                says: Reason::RecordsNotEvaluated,
            });
            continue;
        }
        let value = |input: &InputNode| {
            found.number(input.node).map(|(value, _)| value).map_err(|_| Reason::NoTrackRecord)
        };
        let inputs: Vec<Result<f64, Reason>> = inputs.iter().map(value).collect();
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
            let inputs: Vec<Result<f64, Reason>> =
                inputs.iter().map(|input| two.input(input, side)).collect();
            let found = checked(work, check, two.known, &inputs);
            CheckResult {
                says: match record {
                    Some(name) => found.says.about(Subject::Record, name.to_string()),
                    None => found.says,
                },
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
    inputs: &[Result<f64, Reason>],
) -> CheckResult {
    let result = |(holds, says): (Option<bool>, Reason)| CheckResult {
        name: check.name.clone(),
        title: check.title.clone(),
        holds,
        says,
    };
    let spared = check.unless.as_ref().map_or(Ok(false), |unless| flag(unless, known));
    match spared {
        Ok(true) => return result((Some(true), Reason::DoesNotApply)),
        Err(reason) => return result((None, reason)),
        Ok(false) => {}
    }
    let holds = flag(&check.require, &Known { inputs, ..*known });
    result(met(holds, &check.words, || found_values(work, check, inputs)))
}

/// The values found: range of curvature 0.00021 1/m, mean of curvature 0.002 1/m.
fn found_values(work: &Work<'_>, check: &Check, inputs: &[Result<f64, Reason>]) -> Vec<Datum> {
    let one = |(input, value): (&Input, &Result<f64, Reason>)| {
        let value = digits(*value.as_ref().ok()?, DIGITS).to_string();
        let signal = input.signal.as_ref()?;
        let dimension = input.taken.gives(signal.dimension(), work.plan.axis.unit.dimension);
        let unit = (dimension != Dimension::ONE).then(|| dimension.to_string());
        let name = input.span.text().split_whitespace().collect::<Vec<_>>().join(" ");
        Some(Datum { name, value, unit })
    };
    check.inputs.iter().zip(inputs).filter_map(one).collect()
}
