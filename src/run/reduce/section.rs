//! One section: its records through the graph, then rows of the table of values, checks and
//! plausibility.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::check::evaluate::flag;
use crate::check::plan::{Evaluation, Expr, Position, Quantity, Side};
use crate::data::{RecordKind, WhichRecord};
use crate::graph::{InputNode, NodeId, SignalNodes};
use crate::run::data_rules::{Questions, plausibility, record_checks, track_checks};
use crate::run::estimate::Row;
use crate::run::record::{Fault, Found, Opened, Work, with_record};
use crate::run::sections::{Known, Unit};
use crate::run::values::{
    Evaluated, Meetings, Original, RecordOfSide, SectionValues, Shifts, Sides, note_margins,
    one_record, slow, synchronisation,
};

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
            .collect::<Result<Vec<bool>, String>>()
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
    let original = original(work, unit, &active);
    let one = |measured: Result<Vec<RecordOfSide>, String>| {
        let mut values = common.clone();
        match measured {
            Ok(measured) => {
                let meetings = Meetings::default();
                let sides = Sides::of_section(
                    work,
                    unit,
                    (&simulated, &measured),
                    original.as_ref(),
                    (&known, &meetings),
                );
                quantities(work, &sides, &active, &mut values);
                record_checks(work, &sides, &mut values);
                plausibility::look((work, unit), &questions, &sides, &track, &mut values);
            }
            Err(says) => values.fault = Some(says),
        }
        values
    };
    Ok(measured.into_iter().map(one).collect())
}

/// The evaluated records of one side; empty where the protocol does not read that side.
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
    let mut records: Result<Vec<RecordOfSide>, Fault> = Ok(Vec::new());
    for which in work.campaign(unit).records(side.kind()) {
        let one = one_record(work, unit, which, wanted, known, common).map(|(found, opened)| {
            // The first measurement defines the range of a whole record; without measurements, the
            // simulation.
            if side == Side::Measured && which.number == 0 || common.extent.is_none() {
                common.extent = Some(opened.extent);
            }
            of_side(work, unit, which, found)
        });
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

fn of_side(
    work: &Work<'_>,
    unit: &Unit,
    which: WhichRecord,
    found: Vec<(NodeId, Found)>,
) -> RecordOfSide {
    let (campaign, found) = (work.campaign(unit), Evaluated::from(found));
    RecordOfSide {
        name: campaign.record_name(which).cloned(),
        called: campaign.record_called(which).cloned(),
        which,
        found,
    }
}

/// The section that this one repeats, with the values that quantities of repeats need. If it cannot
/// be evaluated, it is itself not used and states the reason.
fn original<'a>(work: &Work<'a>, unit: &Unit, active: &Active) -> Option<Original<'a>> {
    let original = work.units.get(unit.original?)?;
    let mut wanted = BTreeSet::new();
    for (index, quantity) in work.graph.quantities.iter().enumerate() {
        let rule = &work.plan.quantities[index];
        if rule.evaluation.of_repeats() {
            let signals =
                quantity.signals.iter().zip(&active[index]).filter(|(_, active)| **active);
            signals.for_each(|(signal, _)| wanted_of(rule, signal, &mut wanted));
        }
    }
    if wanted.is_empty() || original.fault.is_some() {
        return None;
    }
    let known = original.known(work.facts);
    // Its files and margins are reported with the original itself.
    let records =
        records(work, original, Side::Measured, &wanted, &known, &mut SectionValues::default())
            .ok()?;
    Some(Original { unit: original, known, records })
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
    let which = RecordKind::Measurement.into();
    let evaluate = |opened: &Opened, needed: &BTreeSet<NodeId>| {
        let held =
            opened.hold(work.graph, needed, wanted, known, work.plan.sections.percentiles)?;
        let first = shifts.farthest.zip(simulated.first());
        let offset = first.and_then(|(farthest, simulated)| {
            synchronisation::estimate(work.graph, unit, farthest, &simulated.found, &held)
        });
        let own = offset.as_ref().filter(|_| shifts.correct).map_or(0.0, |offset| offset.shift);
        let placed = |says: String| format!("{}: {says}", opened.file.path);
        let at = |offset: &f64| {
            held.at(own + offset)
                .map(|found| vec![of_side(work, unit, which, found)])
                .map_err(placed)
        };
        Ok((shifts.offsets.iter().map(at).collect(), offset, slow(work, needed)))
    };
    let (found, opened) = with_record(work, unit, which, wanted, known, evaluate)?;
    common.files.push(opened.file.clone());
    common.extent = Some(opened.extent);
    let (all, offset, slow) = found?;
    common.offset = offset;
    note_margins(unit, slow, &opened, common);
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
            match sides.rows(work, number, nodes) {
                Ok(found) => rows.extend(found),
                Err(says) => values
                    .impossible
                    .push((index, format!("{}: {says}", quantity.positions[number].name))),
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
    for (index, quantity) in work.graph.quantities.iter().enumerate() {
        let rule = &work.plan.quantities[index];
        if rule.evaluation.reads(side) {
            let signals =
                quantity.signals.iter().zip(&active[index]).filter(|(_, active)| **active);
            signals.for_each(|(signal, _)| wanted_of(rule, signal, &mut wanted));
        }
    }
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

/// The rows of one position and the values of each record.
pub struct Computed {
    pub rows: Vec<Row>,
    pub records: Vec<OneRecord>,
}

/// The values of one record at one position.
pub struct OneRecord {
    /// The column of its value in a row; a repeat takes the place of the simulation.
    pub place: Side,
    pub name: Option<Arc<str>>,
    pub found: Vec<(NodeId, Found)>,
    pub opened: Opened,
}

/// One position of one quantity in one section.
pub fn single(
    work: &Work<'_>,
    unit: &Unit,
    index: usize,
    signal: usize,
) -> Result<Computed, Fault> {
    let known = unit.known(work.facts);
    let nodes = &work.graph.quantities[index].signals[signal];
    let quantity = &work.plan.quantities[index];
    let mut wanted = BTreeSet::new();
    wanted_of(quantity, nodes, &mut wanted);
    let mut all: Vec<OneRecord> = Vec::new();
    let mut read = |unit: &Unit, known: &Known<'_>, side: Side, place: Side| {
        let mut records = Vec::new();
        for which in work.campaign(unit).records(side.kind()) {
            let (found, opened) =
                one_record(work, unit, which, &wanted, known, &mut SectionValues::default())?;
            let record = of_side(work, unit, which, found.clone());
            all.push(OneRecord { place, name: record.name.clone(), found, opened });
            records.push(record);
        }
        Ok::<_, Fault>(records)
    };
    let repeats = quantity.evaluation.of_repeats();
    let mut of = |side: Side| {
        let place = if repeats { Side::Simulated } else { side };
        if quantity.evaluation.reads(side) {
            read(unit, &known, side, place)
        } else {
            Ok(Vec::new())
        }
    };
    let (simulated, measured) = (of(Side::Simulated)?, of(Side::Measured)?);
    let first = unit.original.and_then(|original| work.units.get(original)).filter(|_| repeats);
    let original = match first {
        Some(first) => {
            let known = first.known(work.facts);
            let records = read(first, &known, Side::Measured, Side::Measured)?;
            Some(Original { unit: first, known, records })
        }
        None => None,
    };
    let meetings = Meetings::default();
    let sides = Sides::of_section(
        work,
        unit,
        (&simulated, &measured),
        original.as_ref(),
        (&known, &meetings),
    );
    let rows = sides.rows(work, signal, nodes).map_err(Fault::new)?;
    Ok(Computed { rows, records: all })
}
