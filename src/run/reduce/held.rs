//! Sections whose measured records stay in memory, to be evaluated again with channels that are
//! calibrated otherwise, or moved along the axis. Records are not read again.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::{
    Prepared,
    section::{Active, active, of_quantities, records, rows},
};
use crate::run::{
    prelude::*,
    record::{Calibrated, Held, Lines, NodeValue, Opened, SectionWork, Work},
    sections::needed,
    values::{Meetings, Original, RecordOfSide, SectionValues, Sides},
    verdict::Evaluated,
};

/// What is done to the measurement.
#[derive(Clone, Copy, Debug)]
pub enum Change<'a> {
    /// Its channels are calibrated otherwise.
    Calibrated(&'a Lines),
    /// It is moved along the axis, SI.
    Moved(f64),
}

/// A measured record that was read.
#[derive(Debug)]
struct Read {
    which: WhichRecord,
    opened: Opened,
    wanted: BTreeSet<NodeId>,
    needed: BTreeSet<NodeId>,
    recorded: Vec<(NodeId, NodeValue)>,
}

/// A section that was read.
#[derive(Debug)]
struct ReadSection<'a> {
    section: SectionWork<'a>,
    active: Active,
    /// Quantities that are not evaluated, and why.
    absent: Vec<(usize, Reason)>,
    simulated: Vec<RecordOfSide>,
    measured: Vec<Read>,
    /// The section that it repeats.
    original: Option<(SectionWork<'a>, Vec<Read>)>,
}

/// A measured record, ready to be evaluated again.
#[derive(Debug)]
struct Ready<'a> {
    read: &'a Read,
    section: &'a SectionWork<'a>,
    calibrated: Calibrated<'a>,
    held: Option<Held<'a>>,
}

impl Ready<'_> {
    fn with(&self, change: Change<'_>) -> Result<RecordOfSide, Reason> {
        let found = match (change, &self.held) {
            (Change::Calibrated(lines), _) => self.calibrated.with(lines)?,
            (Change::Moved(shift), Some(held)) => held.at(shift)?,
            (Change::Moved(_), None) => return Err(Reason::Internal),
        };
        Ok(RecordOfSide::new(self.section, self.read.which, &self.read.opened, found))
    }
}

#[derive(Debug)]
struct ReadySection<'a> {
    read: &'a ReadSection<'a>,
    measured: Vec<Ready<'a>>,
    original: Option<(SectionWork<'a>, Vec<Ready<'a>>)>,
}

/// A campaign with its measured records in memory.
#[derive(Debug)]
pub struct Holding<'a> {
    plan: &'a Plan,
    /// As recorded.
    pub base: &'a Evaluated,
    /// `None` of a section that is not used.
    sections: Vec<Option<ReadySection<'a>>>,
    /// The columns that each quantity reads.
    columns: Vec<BTreeSet<String>>,
}

/// Reads the records of the sections that are used, and evaluates them again as `then` asks.
/// `moves`: whether they are moved too.
///
/// # Errors
/// A record that was read before cannot be read now, and why.
pub fn hold<T>(
    prepared: &Prepared<'_>,
    base: &Evaluated,
    moves: bool,
    then: impl FnOnce(&Holding<'_>) -> T,
) -> Result<T, Reason> {
    let work = prepared.work();
    let units = &prepared.basis.units;
    let read = |at: usize| match base.units[at].fault {
        None => read_section(SectionWork::new(&work, &units[at])).map(Some),
        Some(_) => Ok(None),
    };
    let sections: Result<Vec<Option<ReadSection<'_>>>, Reason> =
        (0..units.len()).into_par_iter().map(read).collect();
    let sections = sections?;
    let ready: Result<Vec<Option<ReadySection<'_>>>, Reason> = sections
        .par_iter()
        .map(|read| read.as_ref().map(|read| ready_section(read, moves)).transpose())
        .collect();
    let columns =
        (0..prepared.plan.quantities.len()).map(|index| columns(prepared.graph, index)).collect();
    Ok(then(&Holding { plan: prepared.plan, base, sections: ready?, columns }))
}

fn read_section(section: SectionWork<'_>) -> Result<ReadSection<'_>, Reason> {
    let (active, absent) = active(&section)?;
    let work = section.work;
    let wanted = |which: &dyn Fn(&Evaluation) -> bool| {
        let mut wanted = BTreeSet::new();
        of_quantities(work, &active, which, &mut wanted);
        wanted
    };
    let of_side = |side: Side| wanted(&|evaluation| evaluation.reads(side));
    let scratch = &mut SectionValues::default();
    let simulated = records(&section, Side::Simulated, &of_side(Side::Simulated), scratch);
    let simulated = simulated.map_err(|fault| fault.reason)?;
    let measured = match work.plan.reads(Side::Measured) {
        true => read_records(&section, &of_side(Side::Measured))?,
        false => Vec::new(),
    };
    let repeated = wanted(&Evaluation::of_repeats);
    let original = section.unit.original.and_then(|original| work.units.get(original));
    let original = match original.filter(|unit| unit.fault.is_none() && !repeated.is_empty()) {
        None => None,
        Some(unit) => {
            let original = SectionWork::new(work, unit);
            Some((original, read_records(&original, &repeated)?))
        }
    };
    Ok(ReadSection { section, active, absent, simulated, measured, original })
}

fn read_records(section: &SectionWork<'_>, wanted: &BTreeSet<NodeId>) -> Result<Vec<Read>, Reason> {
    let Work { plan, graph, .. } = *section.work;
    let one = |which: WhichRecord| {
        let (found, opened) = section
            .with_record(which, wanted, |opened, needed| {
                opened.evaluate((plan, graph), needed, wanted, &section.known, None)
            })
            .map_err(|fault| fault.reason)?;
        let recorded = found.map_err(|fault| fault.reason)?;
        let needed = needed(graph, wanted, &section.known)?;
        Ok(Read { which, opened, wanted: wanted.clone(), needed, recorded })
    };
    section.campaign().records(Side::Measured.kind()).into_iter().map(one).collect()
}

fn ready_section<'a>(read: &'a ReadSection<'a>, moves: bool) -> Result<ReadySection<'a>, Reason> {
    let all = |section: &'a SectionWork<'a>, records: &'a [Read]| -> Result<Vec<_>, Reason> {
        records.iter().map(|read| ready(section, read, moves)).collect()
    };
    let original = match &read.original {
        None => None,
        Some((section, records)) => Some((*section, all(section, records)?)),
    };
    Ok(ReadySection { read, measured: all(&read.section, &read.measured)?, original })
}

fn ready<'a>(
    section: &'a SectionWork<'a>,
    read: &'a Read,
    moves: bool,
) -> Result<Ready<'a>, Reason> {
    let of = (section.work.plan, section.work.graph);
    let held = match moves {
        true => Some(read.opened.hold(of, &read.needed, &read.wanted, &section.known)?),
        false => None,
    };
    let (recorded, needed) = (read.recorded.clone(), read.needed.clone());
    let calibrated = Calibrated::new(&read.opened, of, &section.known, recorded, needed);
    Ok(Ready { read, section, calibrated, held })
}

/// The columns of the records that a quantity reads.
fn columns(graph: &Graph, quantity: usize) -> BTreeSet<String> {
    let mut open: Vec<NodeId> =
        graph.quantities[quantity].signals.iter().map(|signal| signal.compare).collect();
    let (mut seen, mut columns) = (BTreeSet::new(), BTreeSet::new());
    while let Some(id) = open.pop() {
        if !seen.insert(id) {
            continue;
        }
        let node = &graph.nodes[id];
        if let Operation::Read { column } = &node.operation
            && !node.track
        {
            columns.insert(column.clone());
        }
        open.extend(&node.inputs);
    }
    columns
}

impl Holding<'_> {
    fn records(&self) -> impl Iterator<Item = &Opened> {
        let sections = self.sections.iter().flatten();
        sections.flat_map(|section| section.measured.iter().map(|ready| &ready.read.opened))
    }

    /// The largest magnitude of a column in the sections, SI; `None` where none has it.
    pub fn peak(&self, column: &str) -> Option<f64> {
        let of_record = |opened: &Opened| {
            let inside = opened.sampled.along.inside(opened.extent);
            let values = opened.sampled.column(column)?.get(inside)?;
            values.iter().map(|value| value.abs()).reduce(f64::max)
        };
        self.records().filter_map(of_record).reduce(f64::max)
    }

    /// The length of the shortest section, SI of the axis.
    pub fn shortest(&self) -> Option<f64> {
        self.records().map(|opened| opened.extent.1 - opened.extent.0).reduce(f64::min)
    }

    /// The campaign with the measurement changed. Sections that are not used stay so.
    pub fn with(&self, change: Change<'_>) -> Evaluated {
        let changes = |index: usize| match change {
            Change::Moved(_) => true,
            Change::Calibrated(lines) => {
                self.columns[index].iter().any(|column| lines.contains_key(column))
            }
        };
        let values = |(ready, base): (&Option<ReadySection<'_>>, &SectionValues)| match ready {
            Some(ready) => ready.values(change, base, &changes),
            None => SectionValues::default(),
        };
        let values = self.sections.par_iter().zip(&self.base.values).map(values).collect();
        self.base.in_trial(self.plan, values)
    }
}

impl ReadySection<'_> {
    fn values(
        &self,
        change: Change<'_>,
        base: &SectionValues,
        changes: &dyn Fn(usize) -> bool,
    ) -> SectionValues {
        let mut values = SectionValues { extent: base.extent, ..SectionValues::default() };
        if let Err(reason) = self.fill(change, (base, changes), &mut values) {
            values.fault = Some(reason);
        }
        values
    }

    fn fill(
        &self,
        change: Change<'_>,
        (base, changes): (&SectionValues, &dyn Fn(usize) -> bool),
        values: &mut SectionValues,
    ) -> Result<(), Reason> {
        let again = |all: &[Ready<'_>]| -> Result<Vec<RecordOfSide>, Reason> {
            all.iter().map(|ready| ready.with(change)).collect()
        };
        let measured = again(&self.measured)?;
        let original = match &self.original {
            None => None,
            Some((section, records)) => {
                Some(Original { section: *section, records: again(records)? })
            }
        };
        let sides = Sides {
            section: &self.read.section,
            simulated: &self.read.simulated,
            measured: &measured,
            original: original.as_ref(),
            meetings: Meetings::default(),
        };
        for (index, recorded) in base.rows.iter().enumerate() {
            if changes(index) {
                let own = self.read.absent.iter().filter(|(of, _)| *of == index);
                values.impossible.extend(own.cloned());
                let rows = rows(&sides, &self.read.active, index, values);
                values.rows.push(rows);
            } else {
                let own = base.impossible.iter().filter(|(of, _)| *of == index);
                values.impossible.extend(own.cloned());
                values.rows.push(recorded.clone());
            }
        }
        Ok(())
    }
}
