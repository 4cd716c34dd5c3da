//! Evaluation of the nodes of a graph on one record.

use std::{collections::BTreeSet, sync::Arc};

use indexmap::IndexMap;

use super::{
    memo::{Computed, Keys, Memo},
    opened::Opened,
    signal::{Cutter, Samples, Signal, apply, arithmetic, choose, each, mapped},
};
use crate::catalog::Reducer;
use crate::metrics::{percentile::percentiles, sampling::Traits};
use crate::run::{
    prelude::*,
    sections::{Extent, Known, chosen},
};

/// Value of a requested node.
#[derive(Clone, Debug)]
pub enum NodeValue {
    /// A value of a signal, and the number of samples or windows.
    Number(f64, usize),
    Samples(Samples),
    /// The value cannot be computed from this record: the reason.
    Failed(Reason),
}

/// The nodes of a graph on one record, level by level.
#[derive(Clone, Debug)]
pub struct State<'a> {
    pub opened: &'a Opened,
    pub plan: &'a Plan,
    pub graph: &'a Graph,
    pub known: &'a Known<'a>,
    pub values: Vec<Option<Signal>>,
    /// Why a node has no value. Nodes that depend on it have none either; the others run on.
    pub failed: Vec<Option<Reason>>,
    /// Number of nodes that still need the value.
    pub uses: Vec<usize>,
    pub cutter: Cutter,
    /// The part of the section that is evaluated.
    pub extent: Extent,
    pub found: Vec<(NodeId, NodeValue)>,
    /// Where results are kept for other protocols, and under which numbers.
    pub memo: Option<(&'a Memo, &'a Keys)>,
}

impl<'a> State<'a> {
    pub fn new(
        opened: &'a Opened,
        (plan, graph): (&'a Plan, &'a Graph),
        known: &'a Known<'a>,
    ) -> Self {
        let nodes = graph.nodes.len();
        let cutter = Cutter::new(opened.extent);
        Self {
            opened,
            plan,
            graph,
            known,
            values: vec![None; nodes],
            failed: vec![None; nodes],
            uses: vec![0; nodes],
            cutter,
            extent: opened.extent,
            found: Vec::new(),
            memo: None,
        }
    }

    /// The needed nodes by level, inputs before the nodes that use them, and the number of uses of
    /// each.
    pub fn count(&mut self, needed: &BTreeSet<NodeId>) -> Vec<Vec<NodeId>> {
        let mut level = vec![0_usize; self.graph.nodes.len()];
        let mut levels: Vec<Vec<NodeId>> = Vec::new();
        for &id in needed {
            for &input in &self.graph.nodes[id].inputs {
                if needed.contains(&input) {
                    self.uses[input] += 1;
                    level[id] = level[id].max(level[input] + 1);
                }
            }
            levels.resize_with(levels.len().max(level[id] + 1), Vec::new);
            levels[level[id]].push(id);
        }
        levels
    }

    /// Runs the chosen nodes and keeps the values of the requested ones.
    pub fn run(
        &mut self,
        levels: &[Vec<NodeId>],
        wanted: &BTreeSet<NodeId>,
        chosen: impl Fn(NodeId) -> bool,
    ) -> Result<(), Reason> {
        for level in levels {
            let here: Vec<NodeId> = level.iter().copied().filter(|&id| chosen(id)).collect();
            let before = self.found.len();
            self.filters(&here)?;
            self.reducers(&here)?;
            for &id in &here {
                if self.values[id].is_none()
                    && self.failed[id].is_none()
                    && !matches!(self.graph.nodes[id].operation, Operation::Reduce(_))
                {
                    self.value(id)?;
                }
            }
            self.keep(&here, before);
            for &id in &here {
                if wanted.contains(&id) {
                    if let Some(reason) = &self.failed[id] {
                        self.found.push((id, NodeValue::Failed(reason.clone())));
                    } else if self.values[id].is_some() {
                        let samples = self.samples(id)?;
                        self.found.push((id, NodeValue::Samples(samples)));
                    }
                }
                self.release(id);
            }
        }
        Ok(())
    }
}

impl State<'_> {
    /// Takes results from a memo, from the nodes in `open` backwards, as far as nodes are `inside`;
    /// what is left to compute.
    pub fn recall(
        &mut self,
        (memo, keys): (&Memo, &Keys),
        mut open: Vec<NodeId>,
        wanted: &BTreeSet<NodeId>,
        inside: impl Fn(NodeId) -> bool,
    ) -> Result<BTreeSet<NodeId>, Reason> {
        let (mut left, mut seen) = (BTreeSet::new(), BTreeSet::new());
        while let Some(id) = open.pop() {
            if !seen.insert(id) {
                continue;
            }
            match keys[id].and_then(|key| memo.get(key)) {
                Some(Computed::Signal(signal)) => {
                    self.values[id] = Some(signal);
                    if wanted.contains(&id) {
                        let samples = self.samples(id)?;
                        self.found.push((id, NodeValue::Samples(samples)));
                    }
                }
                Some(Computed::Number(value, samples)) => {
                    self.found.push((id, NodeValue::Number(value, samples)))
                }
                None => {
                    left.insert(id);
                    let inputs = &self.graph.nodes[id].inputs;
                    open.extend(inputs.iter().filter(|&&input| inside(input)));
                }
            }
        }
        Ok(left)
    }

    /// Counts the filters among nodes for a comparison of protocols.
    pub fn count_asked(&self, memo: &Memo, needed: &BTreeSet<NodeId>) {
        let filters = needed.iter().filter(|&&id| {
            matches!(&self.graph.nodes[id].operation, Operation::Step(spec) if spec.is_filter())
        });
        memo.count_asked(filters.count());
    }

    /// Keeps the results of a level; those before `from` were there already.
    fn keep(&self, here: &[NodeId], from: usize) {
        let Some((memo, keys)) = self.memo else { return };
        let key = |id: NodeId| keys.get(id).copied().flatten();
        for &id in here {
            if let (Some(key), Some(signal)) = (key(id), &self.values[id]) {
                memo.put(key, Computed::Signal(signal.clone()));
            }
        }
        for (id, found) in &self.found[from..] {
            if let (Some(key), NodeValue::Number(value, samples)) = (key(*id), found) {
                memo.put(key, Computed::Number(*value, *samples));
            }
        }
    }

    /// Frees inputs that no later node needs.
    fn release(&mut self, id: NodeId) {
        for &input in &self.graph.nodes[id].inputs {
            if self.uses[input] > 0 {
                self.uses[input] -= 1;
                if self.uses[input] == 0 {
                    self.values[input] = None;
                }
            }
        }
    }

    fn signal(&self, id: NodeId) -> Result<&Signal, Reason> {
        self.values[id]
            .as_ref()
            .ok_or_else(|| self.failed[id].clone().unwrap_or(Reason::InputMissing))
    }

    /// Whether an input has no value. Then this node has none for the same reason.
    fn without_input(&mut self, id: NodeId) -> bool {
        let reason =
            self.graph.nodes[id].inputs.iter().find_map(|&input| self.failed[input].clone());
        let failed = reason.is_some();
        if failed {
            self.failed[id] = reason;
        }
        failed
    }

    fn of_step(&self, id: NodeId, reason: Reason) -> Reason {
        reason.about(Subject::Step, &self.graph.nodes[id].label.text)
    }

    /// Computes a node. Where a step is not possible, or a sample has no finite result, only this
    /// node has no value, and what needs it.
    fn value(&mut self, id: NodeId) -> Result<(), Reason> {
        if self.without_input(id) {
            return Ok(());
        }
        match self.evaluate(id) {
            Ok(value) => self.values[id] = Some(value),
            Err(reason) if self.asks(id) => self.failed[id] = Some(self.of_step(id, reason)),
            Err(reason) if reason.is_of_samples() => {
                let reason = self.of_step(id, reason);
                self.failed[id] = Some(reason.about(Subject::File, &self.opened.file.path));
            }
            Err(reason) => return Err(self.of_step(id, reason)),
        }
        Ok(())
    }

    fn asks(&self, id: NodeId) -> bool {
        matches!(
            self.graph.nodes[id].operation,
            Operation::Step(_)
                | Operation::Window(_)
                | Operation::OverAxis(_)
                | Operation::OfSection(_)
                | Operation::Present
        )
    }

    pub fn samples(&self, id: NodeId) -> Result<Samples, Reason> {
        match self.signal(id)? {
            Signal::Samples(samples) => Ok(samples.clone()),
            // A constant becomes a signal of equal samples where a signal is needed.
            Signal::Constant(value) => Ok(Samples {
                along: Arc::clone(&self.opened.sampled.along),
                values: Arc::new(vec![*value; self.opened.sampled.along.axis.len()]),
            }),
        }
    }

    /// Filters of one level: all channels with the same design together.
    fn filters(&mut self, here: &[NodeId]) -> Result<(), Reason> {
        let mut groups: Vec<(StepSpec, Vec<(NodeId, Samples)>)> = Vec::new();
        for &id in here {
            let node = &self.graph.nodes[id];
            let Operation::Step(spec) = &node.operation else { continue };
            if !spec.is_filter() {
                continue;
            }
            if self.without_input(id) {
                continue;
            }
            let samples = self.samples(node.inputs[0])?;
            let same = groups.iter_mut().find(|(known, members)| {
                known == spec
                    && members[0].1.along.rate == samples.along.rate
                    && members[0].1.values.len() == samples.values.len()
            });
            match same {
                Some((_, members)) => members.push((id, samples)),
                None => groups.push((spec.clone(), vec![(id, samples)])),
            }
        }
        if let Some((memo, _)) = self.memo {
            memo.count_filtered(groups.iter().map(|(_, members)| members.len()).sum());
        }
        for (spec, members) in groups {
            let signals: Vec<&[f64]> =
                members.iter().map(|(_, samples)| samples.values.as_slice()).collect();
            let designed = members[0].1.designed(&spec);
            let filtered =
                designed.and_then(|filter| filter.apply_many(&signals).map_err(Reason::method));
            let filtered = match filtered {
                Ok(filtered) => filtered,
                Err(reason) => {
                    for (id, _) in &members {
                        self.failed[*id] = Some(self.of_step(*id, reason.clone()));
                    }
                    continue;
                }
            };
            for ((id, samples), values) in members.iter().zip(filtered) {
                self.values[*id] = Some(Signal::Samples(samples.with(values)));
            }
        }
        Ok(())
    }

    /// Reducers of one level: those of one signal share what they are computed from.
    fn reducers(&mut self, here: &[NodeId]) -> Result<(), Reason> {
        let mut by_input: IndexMap<NodeId, Vec<(NodeId, Reducer)>> = IndexMap::new();
        for &id in here {
            let node = &self.graph.nodes[id];
            if let Operation::Reduce(reducer) = node.operation
                && !self.without_input(id)
            {
                by_input.entry(node.inputs[0]).or_default().push((id, reducer));
            }
        }
        for (input, members) in by_input {
            let samples = self.samples(input)?;
            let traits = Traits::of(&samples.values);
            let method = self.plan.sections.percentiles;
            let mut percents: Vec<(NodeId, f64)> = Vec::new();
            for (id, reducer) in members {
                if let Reducer::Percentile(percent) = reducer {
                    percents.push((id, percent));
                    continue;
                }
                let over = self.graph.nodes[id].inputs.get(1);
                let over = over.map(|&over| self.samples(over)).transpose()?;
                let axis = over.as_ref().map_or(&samples.along.axis, |over| &over.values);
                let value = reducer.run(axis, &traits, method).filter(|value| value.is_finite());
                match value {
                    Some(value) => self.found.push((id, NodeValue::Number(value, traits.len()))),
                    None => {
                        let (reducer, samples) = (reducer.in_words(), traits.len());
                        self.failed[id] = Some(Reason::ReducerUndefined { reducer, samples });
                    }
                }
            }
            let wanted: Vec<f64> = percents.iter().map(|(_, percent)| *percent).collect();
            match percentiles(&traits, &wanted, method) {
                Ok(values) => {
                    let numbers = percents
                        .iter()
                        .zip(values)
                        .map(|((id, _), value)| (*id, NodeValue::Number(value, traits.len())));
                    self.found.extend(numbers);
                }
                Err(error) => {
                    for (id, _) in percents {
                        self.failed[id] = Some(Reason::method(error));
                    }
                }
            }
        }
        Ok(())
    }

    /// Why a quotient is not finite, if its divisor is zero: the channels that it comes from.
    fn without_zeros(&self, divisor: NodeId, reason: Reason) -> Reason {
        let Some(Signal::Samples(samples)) = &self.values[divisor] else { return reason };
        let zeros = samples.values.iter().filter(|value| **value == 0.0).count();
        let (mut channels, mut open) = (Vec::new(), vec![divisor]);
        while let Some(id) = open.pop() {
            match &self.graph.nodes[id].operation {
                Operation::Read { column } if !channels.contains(column) => {
                    channels.push(column.clone());
                }
                _ => open.extend(&self.graph.nodes[id].inputs),
            }
        }
        match (reason, zeros) {
            (Reason::NotFiniteResult { row, at }, 1..) => {
                let samples = samples.values.len();
                Reason::DividedByZero { channels, zeros, samples, row, at }
            }
            (reason, _) => reason,
        }
    }

    fn evaluate(&mut self, id: NodeId) -> Result<Signal, Reason> {
        let node = &self.graph.nodes[id];
        let input = |index: usize| self.signal(node.inputs[index]);
        match &node.operation {
            Operation::Read { column } => {
                let values = self.opened.sampled.column(column);
                let values = values.ok_or_else(|| Reason::NoChannel { channel: column.clone() })?;
                let along = Arc::clone(&self.opened.sampled.along);
                Ok(Signal::Samples(Samples { along, values: Arc::clone(values) }))
            }
            Operation::Constant(expr) if expr.ty == Type::Flag => {
                Ok(Signal::Constant(f64::from(flag(expr, self.known)?)))
            }
            Operation::Constant(expr) => Ok(Signal::Constant(number(expr, self.known)?)),
            Operation::Level => {
                let of = |(id, found): &(NodeId, NodeValue)| match found {
                    NodeValue::Number(value, _) if *id == node.inputs[0] => Some(*value),
                    _ => None,
                };
                Ok(Signal::Constant(
                    self.found.iter().find_map(of).ok_or(Reason::SectionNumberMissing)?,
                ))
            }
            Operation::Arithmetic(operator) => arithmetic(*operator, input(0)?, input(1)?)
                .map_err(|reason| self.without_zeros(node.inputs[1], reason)),
            Operation::Negative => each(input(0)?, |value| -value),
            Operation::Mapped(mapping) => {
                mapped(input(0)?, mapping, || self.graph.nodes[node.inputs[0]].label.text.clone())
            }
            Operation::Apply(function) => {
                let inputs: Result<Vec<_>, _> =
                    node.inputs.iter().map(|&input| self.signal(input)).collect();
                apply(&inputs?, function.run)
            }
            Operation::Select(conditions) => {
                Ok(input(chosen(conditions, &node.inputs, self.known)?)?.clone())
            }
            Operation::Choose(conditions) => {
                let inputs: Result<Vec<_>, _> =
                    node.inputs.iter().map(|&input| self.signal(input)).collect();
                let inputs = inputs?;
                let (values, conditions) = inputs.split_at(inputs.len() - conditions);
                choose(values, conditions)
            }
            Operation::Present => Ok(Signal::Samples(self.samples(node.inputs[0])?.present()?)),
            Operation::OverAxis(operation) => Ok(Signal::Samples(
                self.samples(node.inputs[0])?.over_axis(operation, self.known, self.extent)?,
            )),
            Operation::OfSection(operation) => {
                Ok(Signal::Samples(self.samples(node.inputs[0])?.of_section(operation)?))
            }
            Operation::Step(spec) => {
                Ok(Signal::Samples(self.samples(node.inputs[0])?.stepped(spec)?))
            }
            Operation::Cut => {
                let samples = self.samples(node.inputs[0])?;
                Ok(Signal::Samples(self.cutter.cut(&samples)?))
            }
            Operation::Window(spec) => {
                let method = self.plan.sections.percentiles;
                let samples = self.samples(node.inputs[0])?;
                Ok(Signal::Samples(samples.windowed(spec, self.extent, method)?))
            }
            _ => Err(Reason::Internal),
        }
    }
}
