//! One section: its records through the graph, then rows of the table of values, checks and plausibility.

use std::collections::BTreeSet;

use super::checks::{record_checks, track_checks};
use super::copies::Print;
use super::facts::Known;
use super::margins::note_margins;
use super::plausibility;
use super::record::{Fault, Found, Opened, Work, needed, open};
use super::sections::Unit;
use super::sides::{Evaluated, RecordOfSide, Sides};
use super::signal::Extent;
use super::synchronisation::{self, Offset, Shifts};
use super::table::Row;
use crate::check::evaluate::flag;
use crate::check::plan::{Evaluation, Expr, Position, Quantity, Side};
use crate::data::RecordKind;
use crate::graph::{InputNode, NodeId, SignalNodes};
use crate::problem::Problem;
use crate::result::{CheckResult, FileHash, Finding};

/// What one section came to.
#[derive(Clone, Debug, Default)]
pub struct SectionValues {
    /// For each quantity the rows of the section; none where the position was not recorded or the quantity leaves the section out.
    pub rows: Vec<Vec<Row>>,
    /// Quantities that cannot be had of this section, with the signal and the reason.
    pub impossible: Vec<(usize, String)>,
    pub checks: Vec<CheckResult>,
    /// What is not plausible in this section alone.
    pub findings: Vec<Finding>,
    /// Marks of the signals that are to differ from others.
    pub prints: Vec<Print>,
    pub files: Vec<FileHash>,
    /// What a whole record covers, as measured.
    pub extent: Option<Extent>,
    /// Record beyond the section [s], where it is too little for a slow filter to settle.
    pub short_margin: Option<f64>,
    /// Where the measurement lies against the simulation, where that was asked for.
    pub offset: Option<Offset>,
    pub fault: Option<String>,
    pub problems: Vec<Problem>,
}

impl Side {
    pub fn kind(self) -> RecordKind {
        match self {
            Self::Simulated => RecordKind::Simulation,
            Self::Measured => RecordKind::Measurement,
        }
    }
}

/// The section, once for each shift.
pub fn of_section(work: &Work<'_>, unit: &Unit, shifts: &Shifts<'_>) -> Vec<SectionValues> {
    let mut common = SectionValues::default();
    match fill(work, unit, shifts, &mut common) {
        Ok(all) => all,
        Err(fault) => {
            common.fault = Some(fault.says);
            common.problems = fault.problems;
            vec![common; shifts.offsets.len()]
        }
    }
}

/// Which positions of which quantities are evaluated in a section.
type Active = Vec<Vec<bool>>;

fn active(work: &Work<'_>, known: &Known<'_>) -> Result<Active, Fault> {
    let holds = |only: Option<&Expr>| only.map_or(Ok(true), |only| flag(only, known));
    let of_quantity = |(quantity, present): (&Quantity, &Vec<bool>)| {
        let all = holds(quantity.only.as_ref())?;
        let of_position = |(position, present): (&Position, &bool)| Ok(all && *present && holds(position.only.as_ref())?);
        quantity.positions.iter().zip(present).map(of_position).collect::<Result<Vec<bool>, String>>()
    };
    work.plan.quantities.iter().zip(work.present).map(of_quantity).collect::<Result<_, _>>().map_err(Fault::new)
}

fn fill(work: &Work<'_>, unit: &Unit, shifts: &Shifts<'_>, common: &mut SectionValues) -> Result<Vec<SectionValues>, Fault> {
    let known = unit.known(work.facts);
    let track = track_checks(work, unit, &known, common)?;
    let active = active(work, &known)?;
    // A record is reduced to numbers before the next one is opened: one record in memory at a time.
    let simulated = records(work, unit, Side::Simulated, &wanted(work, &known, &active, shifts, Side::Simulated), &known, common);
    let wanted = wanted(work, &known, &active, shifts, Side::Measured);
    let measured = match &simulated {
        Ok(simulated) if !shifts.plain() => shifted(work, unit, shifts, &wanted, &known, simulated, common),
        _ => records(work, unit, Side::Measured, &wanted, &known, common).map(|measured| vec![Ok(measured)]),
    };
    let (simulated, measured) = match (simulated, measured) {
        (Ok(simulated), Ok(measured)) => (simulated, measured),
        (Err(first), Err(second)) => return Err(first.and(second)),
        (Err(fault), _) | (_, Err(fault)) => return Err(fault),
    };
    let one = |measured: Result<Vec<RecordOfSide>, String>| {
        let mut values = common.clone();
        match measured {
            Ok(measured) => {
                let sides = Sides {
                    simulated: &simulated,
                    measured: &measured,
                    known: &known,
                    extent: unit.extent,
                    method: work.plan.sections.percentiles,
                };
                quantities(work, &sides, &active, &mut values);
                record_checks(work, &sides.first(), &mut values);
                plausibility::look(work, unit, &sides.first(), &track, &mut values);
            }
            Err(says) => values.fault = Some(says),
        }
        values
    };
    Ok(measured.into_iter().map(one).collect())
}

/// The records of one side, evaluated; none where the protocol does not read that side.
fn records(
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
    let (found, opened) = one_record(work, unit, side.kind(), wanted, known, common)?;
    // The measurement says what a whole record covers, and where there is none, the simulation.
    if side == Side::Measured || common.extent.is_none() {
        common.extent = Some(opened.extent);
    }
    Ok(vec![RecordOfSide { name: None, found }])
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
) -> Result<Vec<Result<Vec<RecordOfSide>, String>>, Fault> {
    let needed = needed(work.graph, wanted, known).map_err(Fault::new)?;
    let opened = open(work, unit, RecordKind::Measurement, &needed)?;
    common.files.push(opened.file.clone());
    common.extent = Some(opened.extent);
    note_margins(work, unit, &needed, &opened, common);
    let placed = |says: String| format!("{}: {says}", opened.file.path);
    let held = opened.hold(work.graph, &needed, wanted, known, work.plan.sections.percentiles).map_err(|says| Fault::new(placed(says)))?;
    common.offset = shifts
        .farthest
        .zip(simulated.first())
        .and_then(|(farthest, simulated)| synchronisation::estimate(work.graph, unit, farthest, &simulated.found, &held));
    let own = if shifts.correct { common.offset.as_ref().map_or(0.0, |offset| offset.shift) } else { 0.0 };
    let at = |offset: &f64| held.at(own + offset).map(|found| vec![RecordOfSide { name: None, found }]).map_err(placed);
    Ok(shifts.offsets.iter().map(at).collect())
}

/// A row that cannot be had is the matter of its quantity: the section serves the others.
fn quantities(work: &Work<'_>, sides: &Sides<'_>, active: &Active, values: &mut SectionValues) {
    for (index, quantity) in work.plan.quantities.iter().enumerate() {
        let mut rows = Vec::new();
        for (number, nodes) in work.graph.quantities[index].signals.iter().enumerate().filter(|(number, _)| active[index][*number]) {
            match sides.rows(work, number, nodes) {
                Ok(found) => rows.extend(found),
                Err(says) => values.impossible.push((index, format!("{}: {says}", quantity.positions[number].name))),
            }
        }
        values.rows.push(rows);
    }
}

/// Nodes whose values are needed of the records of one side.
fn wanted(work: &Work<'_>, known: &Known<'_>, active: &Active, shifts: &Shifts<'_>, side: Side) -> BTreeSet<NodeId> {
    let mut wanted = BTreeSet::new();
    for (index, quantity) in work.graph.quantities.iter().enumerate() {
        let rule = &work.plan.quantities[index];
        if rule.evaluation.reads(side) {
            let signals = quantity.signals.iter().zip(&active[index]).filter(|(_, active)| **active);
            signals.for_each(|(signal, _)| wanted_of(rule, signal, &mut wanted));
        }
    }
    for check in &work.graph.checks {
        wanted.extend(check.iter().flat_map(InputNode::nodes).filter(|&node| !work.graph.nodes[node].track));
    }
    wanted.extend(plausibility::wanted(work, known, false));
    if shifts.farthest.is_some() {
        wanted.extend(synchronisation::signals(work, active));
    }
    wanted
}

/// Nodes that one position of a quantity needs.
fn wanted_of(quantity: &Quantity, signal: &SignalNodes, wanted: &mut BTreeSet<NodeId>) {
    match quantity.evaluation.as_ref() {
        Evaluation::Values { .. } => wanted.extend(signal.values.iter().flat_map(|value| value.inputs.iter().flat_map(InputNode::nodes))),
        Evaluation::Combined(_) => wanted.extend(signal.inputs.iter().flat_map(InputNode::nodes)),
        Evaluation::Metric { metric, .. } => {
            let common = metric.on_common_points(quantity.keeps_samples());
            wanted.insert(if common { signal.filtered } else { signal.processed });
            wanted.extend(signal.over);
        }
    }
}

/// The rows of one position and what each record gave.
pub struct Computed {
    pub rows: Vec<Row>,
    pub records: Vec<(Side, Evaluated, Opened)>,
}

/// One position of one quantity in one section, by itself.
pub fn single(work: &Work<'_>, unit: &Unit, index: usize, signal: usize) -> Result<Computed, Fault> {
    let known = unit.known(work.facts);
    let nodes = &work.graph.quantities[index].signals[signal];
    let quantity = &work.plan.quantities[index];
    let mut wanted = BTreeSet::new();
    wanted_of(quantity, nodes, &mut wanted);
    let mut values = SectionValues::default();
    let mut records = Vec::new();
    for side in Side::ALL.into_iter().filter(|side| quantity.evaluation.reads(*side)) {
        let (found, opened) = one_record(work, unit, side.kind(), &wanted, &known, &mut values)?;
        records.push((side, found, opened));
    }
    let of = |side: Side| -> Vec<RecordOfSide> {
        let all = records.iter().filter(|(of, ..)| *of == side);
        all.map(|(_, found, _)| RecordOfSide { name: None, found: found.clone() }).collect()
    };
    let (simulated, measured) = (of(Side::Simulated), of(Side::Measured));
    let sides =
        Sides { simulated: &simulated, measured: &measured, known: &known, extent: unit.extent, method: work.plan.sections.percentiles };
    let rows = sides.rows(work, signal, nodes).map_err(Fault::new)?;
    Ok(Computed { rows, records })
}

/// One record of a section through the graph.
pub fn one_record(
    work: &Work<'_>,
    unit: &Unit,
    kind: RecordKind,
    wanted: &BTreeSet<NodeId>,
    known: &Known<'_>,
    values: &mut SectionValues,
) -> Result<(Vec<(NodeId, Found)>, Opened), Fault> {
    let needed = needed(work.graph, wanted, known).map_err(Fault::new)?;
    let opened = open(work, unit, kind, &needed)?;
    values.files.push(opened.file.clone());
    let found = opened
        .evaluate(work.graph, &needed, wanted, known, work.plan.sections.percentiles)
        .map_err(|says| Fault::new(format!("{}: {says}", opened.file.path)))?;
    note_margins(work, unit, &needed, &opened, values);
    Ok((found, opened))
}
