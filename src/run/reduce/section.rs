//! One section: its records through the graph, then rows of the table of values, checks and
//! plausibility.

use std::collections::BTreeSet;

use crate::graph::SignalNodes;
use crate::run::{
    data_rules::{Questions, plausibility, record_checks, track_checks},
    prelude::*,
    record::{Fault, SectionWork, Work},
    sections::{Unit, columns::Present},
    values::{
        Meetings, Original, RecordOfSide, Row, SectionValues, Shifts, Sides, synchronisation,
    },
};

/// The values of a section, once for each shift.
pub fn of_section(work: &Work<'_>, unit: &Unit, shifts: &Shifts<'_>) -> Vec<SectionValues> {
    let mut common = SectionValues::default();
    fill(&SectionWork::new(work, unit), shifts, &mut common).unwrap_or_else(|fault| {
        common.fault = Some(fault.reason);
        common.problems = fault.problems;
        vec![common; shifts.offsets.len()]
    })
}

/// The positions of each quantity that are evaluated in a section; those of repeats only in a
/// section that repeats another.
pub type Active = Vec<Vec<bool>>;

/// And the quantities that are not, for want of something optional.
///
/// # Errors
/// A condition that cannot be decided, and why.
pub fn active(section: &SectionWork<'_>) -> Result<(Active, Vec<(usize, Reason)>), Reason> {
    let SectionWork { work, unit, known } = section;
    let holds = |only: &Option<Expr>| only.as_ref().map_or(Ok(true), |only| flag(only, known));
    let quantities = work.plan.quantities.iter().zip(&work.present[unit.campaign]);
    let of_quantity = |index: usize, (quantity, present): (&Quantity, &Present)| {
        let signals = &work.graph.quantities[index].signals;
        if let Some(reason) = &present.absent {
            return Err(reason.clone());
        }
        let all = holds(&quantity.only)?
            && (unit.original.is_some() || !quantity.evaluation.of_repeats());
        let mut nodes = BTreeSet::new();
        signals.iter().for_each(|signal| wanted_of(quantity, signal, &mut nodes));
        if let Some(reason) = section.absent_case(&nodes) {
            return Err(reason);
        }
        let positions = quantity.positions.iter().zip(&present.positions);
        positions.map(|(position, present)| Ok(all && *present && holds(&position.only)?)).collect()
    };
    let (mut active, mut absent) = (Active::new(), Vec::new());
    for (index, (quantity, present)) in quantities.enumerate() {
        active.push(of_quantity(index, (quantity, present)).or_else(|reason| {
            let is_absent = present.absent.is_some() || reason.is_of_optional();
            absent.push((index, reason.clone()));
            if is_absent { Ok(vec![false; quantity.positions.len()]) } else { Err(reason) }
        })?);
    }
    Ok((active, absent))
}

fn fill(
    section: &SectionWork<'_>,
    shifts: &Shifts<'_>,
    common: &mut SectionValues,
) -> Result<Vec<SectionValues>, Fault> {
    let questions = Questions::of(section);
    let track = track_checks(section, &questions, common)?;
    let (active, absent) = active(section).map_err(Fault::new)?;
    common.impossible.extend(absent);
    let wanted = |side: Side| wanted(section, &questions, &active, shifts, side);
    // A record is reduced to numbers before the next one is opened, so that one record is in memory
    // at a time, and of a run one stretch of each.
    let simulated = records(section, Side::Simulated, &wanted(Side::Simulated), common);
    let wanted = wanted(Side::Measured);
    let measured = match &simulated {
        Ok(simulated) if !shifts.plain() => shifted(section, shifts, &wanted, simulated, common),
        _ => records(section, Side::Measured, &wanted, common).map(|measured| vec![Ok(measured)]),
    };
    let (simulated, measured) = both(simulated, measured)?;
    let mut repeated = BTreeSet::new();
    of_quantities(section.work, &active, Evaluation::of_repeats, &mut repeated);
    // A section whose original cannot be evaluated has no rows of repeats; the original itself
    // states the reason.
    let original = original(section, &repeated).and_then(Result::ok);
    let of_shift = |measured: Result<Vec<RecordOfSide>, Reason>| {
        let mut values = common.clone();
        match measured {
            Ok(measured) => {
                let sides = Sides {
                    section,
                    simulated: &simulated,
                    measured: &measured,
                    original: original.as_ref(),
                    meetings: Meetings::default(),
                };
                quantities(&sides, &active, &mut values);
                record_checks(&sides, &mut values);
                plausibility::look(&questions, &sides, &track, &mut values);
            }
            Err(reason) => values.fault = Some(reason),
        }
        values
    };
    Ok(measured.into_iter().map(of_shift).collect())
}

/// Both, or the faults of both.
fn both<A, B>(first: Result<A, Fault>, second: Result<B, Fault>) -> Result<(A, B), Fault> {
    match (first, second) {
        (Ok(first), Ok(second)) => Ok((first, second)),
        (Err(first), Err(second)) => Err(first.and(second)),
        (Err(fault), _) | (_, Err(fault)) => Err(fault),
    }
}

/// The evaluated records of one side; empty where the protocol does not read that side.
///
/// # Errors
/// The faults of all its records.
pub fn records(
    section: &SectionWork<'_>,
    side: Side,
    wanted: &BTreeSet<NodeId>,
    common: &mut SectionValues,
) -> Result<Vec<RecordOfSide>, Fault> {
    let mut records = Ok(Vec::new());
    if !section.work.plan.reads(side) {
        return records;
    }
    for which in section.campaign().records(side.kind()) {
        let record = section.record(which, wanted, common);
        if let Ok(record) = &record
            // The first measurement defines the range of a whole record; without measurements, the
            // simulation.
            && (side == Side::Measured && which.number == 0 || common.extent.is_none())
        {
            common.extent = Some(record.extent);
        }
        records = both(records, record).map(|(mut all, record): (Vec<_>, _)| {
            all.push(record);
            all
        });
    }
    records
}

/// The section that this one repeats, with the values that quantities of repeats need; `None` if
/// there is none that is used.
pub fn original<'a>(
    section: &SectionWork<'a>,
    wanted: &BTreeSet<NodeId>,
) -> Option<Result<Original<'a>, Fault>> {
    let original = section.work.units.get(section.unit.original?)?;
    if wanted.is_empty() || original.fault.is_some() {
        return None;
    }
    let section = SectionWork::new(section.work, original);
    // Its files and margins are reported with the original itself.
    let records = records(&section, Side::Measured, wanted, &mut SectionValues::default());
    Some(records.map(|records| Original { section, records }))
}

/// The measured record cut at every shift; its filters run once.
fn shifted(
    section: &SectionWork<'_>,
    shifts: &Shifts<'_>,
    wanted: &BTreeSet<NodeId>,
    simulated: &[RecordOfSide],
    common: &mut SectionValues,
) -> Result<Vec<Result<Vec<RecordOfSide>, Reason>>, Fault> {
    let Work { plan, graph, .. } = *section.work;
    let which = RecordKind::Measurement.into();
    let mut extent = None;
    let read = section.read(which, wanted, common, |opened, needed| {
        extent = Some(opened.extent);
        let held = opened.hold((plan, graph), needed, wanted, &section.known)?;
        let offset = shifts.farthest.zip(simulated.first()).and_then(|(farthest, simulated)| {
            synchronisation::estimate(graph, section.unit, farthest, &simulated.found, &held)
        });
        let own = offset.as_ref().filter(|_| shifts.correct).map_or(0.0, |offset| offset.shift);
        let at = |offset: &f64| {
            held.at(own + offset)
                .map(|found| vec![RecordOfSide::new(section, which, opened, found)])
                .map_err(|reason| reason.about(Subject::File, &opened.file.path))
        };
        Ok((shifts.offsets.iter().map(at).collect(), offset))
    });
    common.extent = extent.or(common.extent);
    let (all, offset) = read?;
    common.offset = offset;
    Ok(all)
}

/// A row that cannot be computed affects its quantity only; the section is used for the others.
fn quantities(sides: &Sides<'_>, active: &Active, values: &mut SectionValues) {
    for index in 0..sides.section.work.plan.quantities.len() {
        let rows = rows(sides, active, index, values);
        values.rows.push(rows);
    }
}

/// The rows of one quantity; why it has none is kept in the values.
pub fn rows(
    sides: &Sides<'_>,
    active: &Active,
    index: usize,
    values: &mut SectionValues,
) -> Vec<Row> {
    let quantity = &sides.section.work.plan.quantities[index];
    let mut rows = Vec::new();
    for at in (0..quantity.positions.len()).filter(|at| active[index][*at]) {
        match sides.rows(index, at) {
            Ok(found) => rows.extend(found),
            // A record without finite samples where a quantity needs them is not used.
            Err(reason) if reason.is_of_samples() => {
                values.fault.get_or_insert(reason);
            }
            Err(reason) => {
                let signal = &quantity.positions[at].name;
                values.impossible.push((index, reason.about(Subject::Signal, signal)));
            }
        }
    }
    rows
}

/// Nodes whose values are needed from the records of one side.
fn wanted(
    section: &SectionWork<'_>,
    questions: &Questions<'_>,
    active: &Active,
    shifts: &Shifts<'_>,
    side: Side,
) -> BTreeSet<NodeId> {
    let of_questions = match side {
        Side::Simulated => InputSide::Simulated,
        Side::Measured => InputSide::Measured,
    };
    let work = section.work;
    let mut wanted = questions.wanted(work.graph, Some(of_questions));
    of_quantities(work, active, |evaluation| evaluation.reads(side), &mut wanted);
    let of_checks = section.checks().filter(|(_, absent)| absent.is_none());
    let of_checks = of_checks.flat_map(|((_, inputs), _)| inputs.iter().flat_map(InputNode::nodes));
    wanted.extend(of_checks.filter(|&node| !work.graph.nodes[node].track));
    if shifts.farthest.is_some() {
        wanted.extend(synchronisation::signals(work.graph, active));
    }
    wanted
}

/// Adds the nodes that some quantities need at the positions that are evaluated.
pub fn of_quantities(
    work: &Work<'_>,
    active: &Active,
    which: impl Fn(&Evaluation) -> bool,
    wanted: &mut BTreeSet<NodeId>,
) {
    let quantities = work.plan.quantities.iter().zip(&work.graph.quantities).zip(active);
    for ((quantity, nodes), active) in quantities {
        if which(&quantity.evaluation) {
            let signals = nodes.signals.iter().zip(active).filter(|(_, active)| **active);
            signals.for_each(|(signal, _)| wanted_of(quantity, signal, wanted));
        }
    }
}

/// Nodes that one position of a quantity needs.
pub fn wanted_of(quantity: &Quantity, signal: &SignalNodes, wanted: &mut BTreeSet<NodeId>) {
    match quantity.evaluation.as_ref() {
        Evaluation::Values { .. } => {
            let inputs = signal.values.iter().flat_map(|value| &value.inputs);
            wanted.extend(inputs.flat_map(InputNode::nodes));
        }
        Evaluation::Combined { .. } => {
            wanted.extend(signal.inputs.iter().flat_map(InputNode::nodes));
        }
        Evaluation::Metric { metric, .. } => {
            let common = metric.on_common_points(quantity.keeps_samples());
            wanted.insert(if common { signal.filtered } else { signal.processed });
            wanted.extend(signal.over);
        }
    }
}
