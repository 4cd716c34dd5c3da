//! Records of stretches that neighbouring sections share: each is read once, and what no section
//! changes is computed once.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::{Arc, Mutex},
};

use super::{
    memo::{Computed, Memo, locked},
    opened::{Fault, Opened, Reading, Sampled, Stretched, clock},
    signal::{Cutter, Signal},
    state::State,
};
use crate::data::{Record, campaign::ReadFile, checks::check_axis};
use crate::run::{
    prelude::*,
    sections::{Extent, Known},
};

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
    pub fn get(
        &self,
        key: RecordOfStretch,
        read: impl FnOnce() -> Result<Option<Arc<Stretched>>, Fault>,
    ) -> Result<Option<Arc<Stretched>>, Fault> {
        // The sections of a stretch are evaluated one after the other: no one waits for this lock.
        let mut all = locked(&self.0);
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
    pub fn known(&self, key: RecordOfStretch) -> Option<bool> {
        locked(&self.0).get(&key).copied()
    }

    pub fn keep(&self, key: RecordOfStretch, sound: bool) {
        locked(&self.0).insert(key, sound);
    }
}

impl Stretched {
    /// `None` if its axes are not sound somewhere.
    pub fn new(
        plan: &Plan,
        which: WhichRecord,
        (record, read): (Record, ReadFile),
    ) -> Option<Self> {
        let axis = &plan.axis.column;
        let time = clock(plan, which.kind).map_or(axis, |time| &time.column);
        let rate = check_axis(&record, time, axis, None).ok()?.sampling_rate;
        let sampled = Sampled::of_record(plan, which.kind, record, rate);
        Some(Self { sampled, read, numbers: Mutex::default(), results: Memo::default() })
    }

    /// Whether the nodes that no section changes have finite values all along. Their values are
    /// kept for the sections.
    pub fn is_sound(
        self: &Arc<Self>,
        reading: &Reading<'_>,
        graph: &Graph,
        known: &Known<'_>,
    ) -> bool {
        let Some(all) = self.sampled.extent() else { return false };
        let track = reading.which.kind == RecordKind::Track;
        let nodes = common(graph, track, |column| self.sampled.column(column).is_some());
        let whole = Opened { own: Some(all), ..self.opened(reading, all) };
        let mut state = State::new(&whole, (reading.plan, graph), known);
        let levels = state.count(&nodes);
        state.on_stretch(&nodes, &nodes, &levels).is_ok()
    }

    fn opened(self: &Arc<Self>, reading: &Reading<'_>, extent: Extent) -> Opened {
        Opened {
            sampled: self.sampled.clone(),
            extent,
            file: reading.file(&self.read),
            margins: None,
            memo: None,
            own: None,
            stretch: Some(Arc::clone(self)),
        }
    }

    /// The record as one section sees it; `None` if it does not cover the section.
    pub fn section(self: &Arc<Self>, reading: &Reading<'_>) -> Option<Opened> {
        let (extent, (first, last)) = (reading.unit.extent?, self.sampled.extent()?);
        let along = &self.sampled.along;
        let inside = along.inside(extent);
        if extent.0 < first || extent.1 > last || inside.is_empty() {
            return None;
        }
        let times = along.time.as_ref().unwrap_or(&along.axis);
        let margins =
            (times[inside.start] - times[0], times[times.len() - 1] - times[inside.end - 1]);
        Some(Opened {
            margins: self.sampled.in_time.then_some(margins),
            own: reading.own(),
            ..self.opened(reading, extent)
        })
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
pub fn leading(
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
            | Operation::Mapped(_)
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
    pub fn on_stretch(
        &mut self,
        needed: &BTreeSet<NodeId>,
        wanted: &BTreeSet<NodeId>,
        levels: &[Vec<NodeId>],
    ) -> Result<Vec<bool>, Reason> {
        if self.opened.own.is_none() {
            return Ok(vec![false; self.graph.nodes.len()]);
        }
        let early = early(self.graph, needed);
        // A later level would free them before they are put into the memo.
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
    ) -> Result<(), Reason> {
        let mut keys = locked(&stretch.numbers).keys(self.plan, self.graph, self.known);
        keys.iter_mut().zip(early).filter(|(_, early)| !**early).for_each(|(key, _)| *key = None);
        let mut open: Vec<NodeId> = wanted.iter().copied().filter(|&id| early[id]).collect();
        for &user in needed.iter().filter(|&&id| !early[id]) {
            open.extend(self.graph.nodes[user].inputs.iter().filter(|&&input| early[input]));
        }
        let left = self.recall((&stretch.results, &keys), open, wanted, |id| early[id])?;
        self.run(levels, wanted, |id| left.contains(&id))?;
        for id in left {
            if let (Some(key), Some(signal)) = (keys[id], &self.values[id]) {
                stretch.results.put(key, Computed::Signal(signal.clone()));
            }
        }
        Ok(())
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
