//! Records of stretches that neighbouring sections share: each is read once, and what no section
//! changes is computed once.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::{Arc, Mutex, PoisonError};

use super::shared::{Kept, Memo};
use super::signal::{Cutter, Signal};
use super::{
    Fault, FileHash, Found, Opened, Sampled, State, Work, chosen, clock, columns, file_of, part,
};
use crate::check::evaluate::number;
use crate::check::plan::{AxisOperation, Kind, Plan, StepSpec};
use crate::data::campaign::ReadFile;
use crate::data::checks::check_axis;
use crate::data::record::Wanted;
use crate::data::{Record, RecordKind, WhichRecord};
use crate::graph::{Graph, NodeId, Operation};
use crate::run::sections::Unit;

/// A record of the stretch with this number.
type RecordOfStretch = (usize, WhichRecord);

/// The records of the stretches that a worker reads; `None` for one that is not sound.
#[derive(Debug, Default)]
pub struct Stretches(Mutex<BTreeMap<RecordOfStretch, Option<Arc<Stretched>>>>);

impl Stretches {
    /// A record of a stretch, read unless it is there.
    ///
    /// # Errors
    /// Of `read`.
    fn get(
        &self,
        key: RecordOfStretch,
        read: impl FnOnce() -> Result<Option<Arc<Stretched>>, Fault>,
    ) -> Result<Option<Arc<Stretched>>, Fault> {
        // The sections of a stretch are evaluated one after the other: no one waits for this lock.
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = all.get(&key) {
            return Ok(known.clone());
        }
        let found = read()?;
        all.insert(key, found.clone());
        Ok(found)
    }
}

/// Which records of stretches are sound: all that a protocol reads of them and that no section
/// changes has finite values. A section is evaluated on its stretch if that is sound, and else on
/// what it reads by itself, whatever is asked of it: its values do not depend on what else is
/// asked.
#[derive(Debug, Default)]
pub struct Soundness(Mutex<BTreeMap<RecordOfStretch, bool>>);

impl Soundness {
    fn known(&self, key: RecordOfStretch) -> Option<bool> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get(&key).copied()
    }

    fn keep(&self, key: RecordOfStretch, sound: bool) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).insert(key, sound);
    }
}

/// The stretch of a section, if it is sound. Once it is known to be, only the columns are read that
/// are wanted, outside a group of sections.
///
/// # Errors
/// The record cannot be read at all, now.
pub(super) fn shared(
    work: &Work<'_>,
    unit: &Unit,
    which: WhichRecord,
    wanted: &[Wanted],
) -> Result<Option<Arc<Stretched>>, Fault> {
    let Some(stretch) = unit.stretch else { return Ok(None) };
    let key = (stretch.number, which);
    let read = |wanted: &[Wanted]| match work.campaign(unit).read(
        which,
        &unit.cell,
        wanted,
        Some(&stretch.part(work.plan)),
    ) {
        Ok(read) => Ok(Stretched::new(work.plan, which, read).map(Arc::new)),
        Err(problems) if problems.iter().any(|problem| problem.code == "file-unreadable") => {
            Err(Fault::of(work.campaign(unit), problems))
        }
        Err(_) => Ok(None),
    };
    match (work.soundness.known(key), work.stretches) {
        (Some(false), _) => Ok(None),
        (Some(true), None) => read(wanted),
        (_, stretches) => {
            let alone = Stretches::default();
            let found = stretches.unwrap_or(&alone).get(key, || {
                let all =
                    read(&columns(work, which, &(0..work.graph.nodes.len()).collect(), false))?;
                Ok(all.filter(|stretched| stretched.is_sound(work, unit, which)))
            })?;
            work.soundness.keep(key, found.is_some());
            Ok(found)
        }
    }
}

/// Whether the stretch of a section is sound.
///
/// # Errors
/// As of [`shared`].
pub(super) fn is_sound(work: &Work<'_>, unit: &Unit, which: WhichRecord) -> Result<bool, Fault> {
    match unit.stretch.and_then(|stretch| work.soundness.known((stretch.number, which))) {
        Some(known) => Ok(known),
        None => shared(work, unit, which, &[]).map(|found| found.is_some()),
    }
}

/// A record of a stretch, and the values of nodes on it.
#[derive(Debug)]
pub struct Stretched {
    sampled: Sampled,
    read: ReadFile,
    numbers: Mutex<HashMap<Does, usize>>,
    results: Memo,
}

/// What a node does: nodes that do the same have the same value, whatever section asks.
#[derive(Debug, PartialEq, Eq, Hash)]
struct Does {
    node: NodeId,
    /// Numbers of what its inputs do.
    inputs: Vec<usize>,
    /// The bits of a number that may depend on the section.
    number: Option<u64>,
}

impl Stretched {
    /// `None` if its axes are not sound somewhere.
    fn new(plan: &Plan, which: WhichRecord, (record, read): (Record, ReadFile)) -> Option<Self> {
        let axis = &plan.axis.column;
        let time = clock(plan, which).map_or(axis.as_str(), |time| time.column.as_str());
        let rate = check_axis(&record, time, axis, None).ok()?.sampling_rate;
        let sampled = Sampled::new(plan, which, record, rate);
        Some(Self { sampled, read, numbers: Mutex::default(), results: Memo::default() })
    }

    /// Whether the nodes that no section changes have finite values all along. Their values are
    /// kept for the sections.
    fn is_sound(self: &Arc<Self>, work: &Work<'_>, unit: &Unit, which: WhichRecord) -> bool {
        let Sampled { columns, along, .. } = &self.sampled;
        let (Some(first), Some(last)) = (along.axis.first(), along.axis.last()) else {
            return false;
        };
        let nodes = common(work.graph, which.kind == RecordKind::Track, |column| {
            columns.iter().any(|(name, _)| name == column)
        });
        let whole = Opened {
            columns: Arc::clone(columns),
            along: Arc::clone(along),
            extent: (*first, *last),
            file: file_of(work, unit, which, &self.read),
            margins: None,
            memo: None,
            own: Some((*first, *last)),
            stretch: Some(Arc::clone(self)),
        };
        let known = unit.known(work.facts);
        let mut state = State::new(&whole, work.graph, &known, work.plan.sections.percentiles);
        let levels = state.count(&nodes);
        state.on_stretch(&nodes, &nodes, &levels).is_ok()
    }

    /// The record as one section sees it; `None` if it does not cover the section.
    pub(super) fn section(
        self: &Arc<Self>,
        work: &Work<'_>,
        unit: &Unit,
        which: WhichRecord,
    ) -> Option<Opened> {
        let (extent, Sampled { columns, along, in_time }) = (unit.extent?, &self.sampled);
        let (first, last) = (*along.axis.first()?, *along.axis.last()?);
        let inside = along.inside(extent);
        if extent.0 < first || extent.1 > last || inside.is_empty() {
            return None;
        }
        let times = along.time.as_ref().unwrap_or(&along.axis);
        let margins = in_time.then(|| {
            (times[inside.start] - times[0], times[times.len() - 1] - times[inside.end - 1])
        });
        let file: FileHash = file_of(work, unit, which, &self.read);
        let own = part(work.plan, unit).map(|part| (part.from, part.to));
        let (columns, along, stretch) =
            (Arc::clone(columns), Arc::clone(along), Some(Arc::clone(self)));
        Some(Opened { columns, along, extent, file, margins, memo: None, own, stretch })
    }

    pub(super) fn has(&self, column: &str) -> bool {
        self.sampled.columns.iter().any(|(name, _)| name == column)
    }

    fn number(&self, does: Does) -> usize {
        let mut numbers = self.numbers.lock().unwrap_or_else(PoisonError::into_inner);
        let next = numbers.len();
        *numbers.entry(does).or_insert(next)
    }
}

/// Whether a value depends on samples far away, so that it must be computed on the whole stretch.
fn far(operation: &Operation) -> bool {
    match operation {
        Operation::Step(spec) => !matches!(spec, StepSpec::Magnitude),
        Operation::OverAxis(AxisOperation::Shifted(_)) => false,
        Operation::OverAxis(_) => true,
        _ => false,
    }
}

/// Whether a node, or one that leads to it, depends on the place of the section: it is computed on
/// what the section would read by itself.
fn bound(graph: &Graph, needed: &BTreeSet<NodeId>) -> Vec<bool> {
    let here = |operation: &Operation| match operation {
        Operation::Cut | Operation::Window(_) | Operation::Reduce(_) => true,
        Operation::OverAxis(operation) => matches!(operation, AxisOperation::Shifted(_)),
        _ => false,
    };
    leading(graph, needed, here)
}

/// Nodes with a property, and those that they lead to.
pub(super) fn leading(
    graph: &Graph,
    needed: &BTreeSet<NodeId>,
    has: impl Fn(&Operation) -> bool,
) -> Vec<bool> {
    let mut found = vec![false; graph.nodes.len()];
    for &id in needed {
        let node = &graph.nodes[id];
        found[id] = has(&node.operation) || node.inputs.iter().any(|&input| found[input]);
    }
    found
}

/// Nodes that are computed on the whole stretch: columns, and what leads to a value that depends on
/// samples far away.
fn early(graph: &Graph, needed: &BTreeSet<NodeId>) -> Vec<bool> {
    let bound = bound(graph, needed);
    let mut early = vec![false; graph.nodes.len()];
    for &id in needed.iter().rev() {
        let node = &graph.nodes[id];
        early[id] = !bound[id]
            && (early[id]
                || far(&node.operation)
                || matches!(node.operation, Operation::Read { .. }));
        if early[id] || far(&node.operation) {
            node.inputs
                .iter()
                .filter(|input| needed.contains(input))
                .for_each(|&input| early[input] = true);
        }
    }
    early
}

/// The nodes of a record that no section changes, as far as it has their columns.
fn common(graph: &Graph, track: bool, has: impl Fn(&str) -> bool) -> BTreeSet<NodeId> {
    let mut common = BTreeSet::new();
    for (id, node) in graph.nodes.iter().enumerate() {
        let same = match &node.operation {
            Operation::Read { column } => node.track == track && has(column),
            Operation::Constant(of) => matches!(of.kind, Kind::Constant(_)),
            Operation::Arithmetic(_)
            | Operation::Negative
            | Operation::Power(_)
            | Operation::Apply(_)
            | Operation::Step(_) => true,
            Operation::OverAxis(operation) => !matches!(operation, AxisOperation::Shifted(_)),
            _ => false,
        };
        if same && node.inputs.iter().all(|input| common.contains(input)) {
            common.insert(id);
        }
    }
    common
}

impl State<'_> {
    /// Computes the nodes that must be computed on the whole stretch, or takes their values from
    /// sections that did, and shortens them to what the section would read by itself: what follows
    /// takes no longer, and is the same whoever asks. What is only cut, or averaged in windows of
    /// the section, stays as it is. Gives which nodes these are.
    ///
    /// # Errors
    /// As of [`State::run`].
    pub(super) fn on_stretch(
        &mut self,
        needed: &BTreeSet<NodeId>,
        wanted: &BTreeSet<NodeId>,
        levels: &[Vec<NodeId>],
    ) -> Result<Vec<bool>, String> {
        if self.opened.own.is_none() {
            return Ok(vec![false; self.graph.nodes.len()]);
        }
        let early = early(self.graph, needed);
        // Kept until they are noted: a later level would free them.
        let uses = self.uses.clone();
        self.uses.iter_mut().for_each(|uses| *uses += 1);
        match self.opened.stretch.clone() {
            Some(stretch) => self.together(&stretch, (needed, wanted), levels, &early)?,
            None => self.run(levels, wanted, |id| early[id])?,
        }
        self.uses = uses;
        self.shorten(needed, &early);
        Ok(early)
    }

    fn together(
        &mut self,
        stretch: &Stretched,
        (needed, wanted): (&BTreeSet<NodeId>, &BTreeSet<NodeId>),
        levels: &[Vec<NodeId>],
        early: &[bool],
    ) -> Result<(), String> {
        let numbers = self.numbers(stretch, needed, early);
        let mut open: Vec<NodeId> = wanted.iter().copied().filter(|&id| early[id]).collect();
        for &user in needed.iter().filter(|&&id| !early[id]) {
            open.extend(self.graph.nodes[user].inputs.iter().filter(|&&input| early[input]));
        }
        let mut left = vec![false; early.len()];
        let mut seen = vec![false; early.len()];
        while let Some(id) = open.pop() {
            if std::mem::replace(&mut seen[id], true) {
                continue;
            }
            match numbers[id].and_then(|number| stretch.results.get(number)) {
                Some(Kept::Signal(signal)) => {
                    self.values[id] = Some(signal);
                    if wanted.contains(&id) {
                        let samples = self.samples(id)?;
                        self.found.push((id, Found::Samples(samples)));
                    }
                }
                _ => {
                    left[id] = true;
                    open.extend(self.graph.nodes[id].inputs.iter().filter(|&&input| early[input]));
                }
            }
        }
        self.run(levels, wanted, |id| left[id])?;
        for id in (0..early.len()).filter(|&id| left[id]) {
            if let (Some(number), Some(signal)) = (numbers[id], &self.values[id]) {
                stretch.results.put(number, Kept::Signal(signal.clone()));
            }
        }
        Ok(())
    }

    /// The number of what each early node does; `None` where only this section has its value.
    fn numbers(
        &self,
        stretch: &Stretched,
        needed: &BTreeSet<NodeId>,
        early: &[bool],
    ) -> Vec<Option<usize>> {
        let mut numbers: Vec<Option<usize>> = vec![None; early.len()];
        for &id in needed.iter().filter(|&&id| early[id]) {
            let node = &self.graph.nodes[id];
            let of = match &node.operation {
                Operation::Select(conditions) => {
                    numbers[id] = chosen(conditions, &node.inputs, self.known)
                        .ok()
                        .and_then(|input| numbers[node.inputs[input]]);
                    continue;
                }
                Operation::Constant(of) => match number(of, self.known) {
                    Ok(number) => Some(number.to_bits()),
                    Err(_) => continue,
                },
                _ => None,
            };
            let inputs: Option<Vec<usize>> =
                node.inputs.iter().map(|&input| numbers[input]).collect();
            numbers[id] =
                inputs.map(|inputs| stretch.number(Does { node: id, inputs, number: of }));
        }
        numbers
    }

    fn shorten(&mut self, needed: &BTreeSet<NodeId>, early: &[bool]) {
        let Some(own) = self.opened.own else { return };
        let mut whole = vec![false; early.len()];
        for &id in needed.iter().filter(|&&id| !early[id]) {
            let node = &self.graph.nodes[id];
            if !matches!(node.operation, Operation::Cut | Operation::Window(_)) {
                node.inputs
                    .iter()
                    .filter(|&&input| early[input])
                    .for_each(|&input| whole[input] = true);
            }
        }
        let mut cutter = Cutter::new(own);
        for id in (0..early.len()).filter(|&id| whole[id]) {
            if let Some(Signal::Samples(samples)) = &self.values[id]
                && let Ok(cut) = cutter.cut(samples)
            {
                self.values[id] = Some(Signal::Samples(cut));
            }
        }
    }
}
