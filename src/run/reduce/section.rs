//! One section: its records through the graph, then rows of the table of values, checks and
//! plausibility.

use std::collections::BTreeSet;

use crate::check::evaluate::flag;
use crate::check::plan::{Evaluation, Expr, Position, Quantity, Side};
use crate::data::RecordKind;
use crate::graph::{InputNode, NodeId, SignalNodes};
use crate::result::{Reason, Subject};
use crate::run::data_rules::{Questions, plausibility, record_checks, track_checks};
use crate::run::record::{Fault, Opened, Work};
use crate::run::sections::{Known, Unit};
use crate::run::values::{
    Meetings, Original, RecordOfSide, SectionValues, Shifts, Sides, one_record, read_record,
    synchronisation,
};

/// The values of a section, once for each shift.
pub fn of_section(work: &Work<'_>, unit: &Unit, shifts: &Shifts<'_>) -> Vec<SectionValues> {
    let mut common = SectionValues::default();
    match fill(work, unit, shifts, &mut common) {
        Ok(all) => all,
        Err(fault) => {
            common.fault = Some(fault.reason);
            common.problems = fault.problems;
            vec![common; shifts.offsets.len()]
        }
    }
}

/// The positions of each quantity that are evaluated in a section; those of repeats only in a
/// section that repeats another.
type Active = Vec<Vec<bool>>;

fn active(work: &Work<'_>, unit: &Unit, known: &Known<'_>) -> Result<Active, Fault> {
    let holds = |only: Option<&Expr>| only.map_or(Ok(true), |only| flag(only, known));
    let of_quantity = |(quantity, present): (&Quantity, &Vec<bool>)| {
        let all = holds(quantity.only.as_ref())?
            && (unit.original.is_some() || !quantity.evaluation.of_repeats());
        let of_position = |(position, present): (&Position, &bool)| {
            Ok(all && *present && holds(position.only.as_ref())?)
        };
        quantity
            .positions
            .iter()
            .zip(present)
            .map(of_position)
            .collect::<Result<Vec<bool>, Reason>>()
    };
    work.plan
        .quantities
        .iter()
        .zip(&work.present[unit.campaign])
        .map(of_quantity)
        .collect::<Result<_, _>>()
        .map_err(Fault::new)
}

fn fill(
    work: &Work<'_>,
    unit: &Unit,
    shifts: &Shifts<'_>,
    common: &mut SectionValues,
) -> Result<Vec<SectionValues>, Fault> {
    let known = unit.known(work.facts);
    let questions = Questions::of(work, unit, &known);
    let track = track_checks(work, unit, &questions, &known, common)?;
    let active = active(work, unit, &known)?;
    // A record is reduced to numbers before the next one is opened, so that one record is in memory
    // at a time, and of a run one stretch of each.
    let simulated = records(
        work,
        unit,
        Side::Simulated,
        &wanted(work, &questions, &active, shifts, Side::Simulated),
        &known,
        common,
    );
    let wanted = wanted(work, &questions, &active, shifts, Side::Measured);
    let measured = match &simulated {
        Ok(simulated) if !shifts.plain() => {
            shifted(work, unit, shifts, &wanted, &known, simulated, common)
        }
        _ => records(work, unit, Side::Measured, &wanted, &known, common)
            .map(|measured| vec![Ok(measured)]),
    };
    let (simulated, measured) = match (simulated, measured) {
        (Ok(simulated), Ok(measured)) => (simulated, measured),
        (Err(first), Err(second)) => return Err(first.and(second)),
        (Err(fault), _) | (_, Err(fault)) => return Err(fault),
    };
    let mut repeated = BTreeSet::new();
    of_quantities(work, &active, |evaluation| evaluation.of_repeats(), &mut repeated);
    // A section whose original cannot be evaluated has no rows of repeats; the original itself
    // states the reason.
    let original = original(work, unit, &repeated).and_then(Result::ok);
    let one = |measured: Result<Vec<RecordOfSide>, Reason>| {
        let mut values = common.clone();
        match measured {
            Ok(measured) => {
                let meetings = Meetings::default();
                let sides = Sides {
                    work,
                    simulated: &simulated,
                    measured: &measured,
                    original: original.as_ref(),
                    known: &known,
                    meetings: &meetings,
                };
                quantities(work, &sides, &active, &mut values);
                record_checks(&sides, &mut values);
                plausibility::look((work, unit), &questions, &sides, &track, &mut values);
            }
            Err(reason) => values.fault = Some(reason),
        }
        values
    };
    Ok(measured.into_iter().map(one).collect())
}

/// The evaluated records of one side; empty where the protocol does not read that side.
///
/// # Errors
/// The faults of all its records.
pub fn records(
    work: &Work<'_>,
    unit: &Unit,
    side: Side,
    wanted: &BTreeSet<NodeId>,
    known: &Known<'_>,
    common: &mut SectionValues,
) -> Result<Vec<RecordOfSide>, Fault> {
    if !work.reads(side) {
        return Ok(Vec::new());
    }
    let mut records: Result<Vec<RecordOfSide>, Fault> = Ok(Vec::new());
    for which in work.campaign(unit).records(side.kind()) {
        let one = one_record(work, unit, which, wanted, known, common);
        if let Ok(one) = &one
            // The first measurement defines the range of a whole record; without measurements, the
            // simulation.
            && (side == Side::Measured && which.number == 0 || common.extent.is_none())
        {
            common.extent = Some(one.extent);
        }
        records = match (records, one) {
            (Ok(mut all), Ok(one)) => {
                all.push(one);
                Ok(all)
            }
            (Err(first), Err(second)) => Err(first.and(second)),
            (Err(fault), _) | (_, Err(fault)) => Err(fault),
        };
    }
    records
}

/// The section that this one repeats, with the values that quantities of repeats need; `None` if
/// there is none that is used.
pub fn original<'a>(
    work: &Work<'a>,
    unit: &Unit,
    wanted: &BTreeSet<NodeId>,
) -> Option<Result<Original<'a>, Fault>> {
    let original = work.units.get(unit.original?)?;
    if wanted.is_empty() || original.fault.is_some() {
        return None;
    }
    let known = original.known(work.facts);
    // Its files and margins are reported with the original itself.
    let mut own = SectionValues::default();
    let records = records(work, original, Side::Measured, wanted, &known, &mut own);
    Some(records.map(|records| Original { unit: original, known, records }))
}

/// The measured record cut at every shift; its filters run once.
fn shifted(
    work: &Work<'_>,
    unit: &Unit,
    shifts: &Shifts<'_>,
    wanted: &BTreeSet<NodeId>,
    known: &Known<'_>,
    simulated: &[RecordOfSide],
    common: &mut SectionValues,
) -> Result<Vec<Result<Vec<RecordOfSide>, Reason>>, Fault> {
    let which = RecordKind::Measurement.into();
    let mut extent = None;
    let evaluate = |opened: &Opened, needed: &BTreeSet<NodeId>| {
        extent = Some(opened.extent);
        let held = opened.hold((work.plan, work.graph), needed, wanted, known)?;
        let first = shifts.farthest.zip(simulated.first());
        let offset = first.and_then(|(farthest, simulated)| {
            synchronisation::estimate(work.graph, unit, farthest, &simulated.found, &held)
        });
        let own = offset.as_ref().filter(|_| shifts.correct).map_or(0.0, |offset| offset.shift);
        let at = |offset: &f64| {
            held.at(own + offset)
                .map(|found| vec![RecordOfSide::new(work, unit, which, opened, found)])
                .map_err(|reason| reason.about(Subject::File, &opened.file.path))
        };
        Ok((shifts.offsets.iter().map(at).collect(), offset))
    };
    let read = read_record(work, unit, which, wanted, known, common, evaluate);
    common.extent = extent.or(common.extent);
    let (all, offset) = read?;
    common.offset = offset;
    Ok(all)
}

/// A row that cannot be computed affects its quantity only; the section is used for the others.
fn quantities(work: &Work<'_>, sides: &Sides<'_>, active: &Active, values: &mut SectionValues) {
    for (index, quantity) in work.plan.quantities.iter().enumerate() {
        let mut rows = Vec::new();
        for (number, nodes) in work.graph.quantities[index]
            .signals
            .iter()
            .enumerate()
            .filter(|(number, _)| active[index][*number])
        {
            match sides.rows(number, nodes) {
                Ok(found) => rows.extend(found),
                Err(reason) => {
                    let signal = &quantity.positions[number].name;
                    values.impossible.push((index, reason.about(Subject::Signal, signal)));
                }
            }
        }
        values.rows.push(rows);
    }
}

/// Nodes whose values are needed from the records of one side.
fn wanted(
    work: &Work<'_>,
    questions: &Questions<'_>,
    active: &Active,
    shifts: &Shifts<'_>,
    side: Side,
) -> BTreeSet<NodeId> {
    let mut wanted = BTreeSet::new();
    of_quantities(work, active, |evaluation| evaluation.reads(side), &mut wanted);
    for check in &work.graph.checks {
        wanted.extend(
            check.iter().flat_map(InputNode::nodes).filter(|&node| !work.graph.nodes[node].track),
        );
    }
    wanted.extend(questions.wanted(work, false));
    if shifts.farthest.is_some() {
        wanted.extend(synchronisation::signals(work, active));
    }
    wanted
}

/// Adds the nodes that some quantities need at the positions that are evaluated.
fn of_quantities(
    work: &Work<'_>,
    active: &Active,
    which: impl Fn(&Evaluation) -> bool,
    wanted: &mut BTreeSet<NodeId>,
) {
    for (index, nodes) in work.graph.quantities.iter().enumerate() {
        let quantity = &work.plan.quantities[index];
        if which(&quantity.evaluation) {
            let signals = nodes.signals.iter().zip(&active[index]).filter(|(_, active)| **active);
            signals.for_each(|(signal, _)| wanted_of(quantity, signal, wanted));
        }
    }
}

/// Nodes that one position of a quantity needs.
pub fn wanted_of(quantity: &Quantity, signal: &SignalNodes, wanted: &mut BTreeSet<NodeId>) {
    match quantity.evaluation.as_ref() {
        Evaluation::Values { .. } => wanted.extend(
            signal.values.iter().flat_map(|value| value.inputs.iter().flat_map(InputNode::nodes)),
        ),
        Evaluation::Combined { .. } => {
            wanted.extend(signal.inputs.iter().flat_map(InputNode::nodes))
        }
        Evaluation::Metric { metric, .. } => {
            let common = metric.on_common_points(quantity.keeps_samples());
            wanted.insert(if common { signal.filtered } else { signal.processed });
            wanted.extend(signal.over);
        }
    }
}
