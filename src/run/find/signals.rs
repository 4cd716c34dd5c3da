//! The signals of a piece of a run, filtered once, and values of any part of it.

use std::{collections::BTreeSet, sync::Arc};

use super::Windows;
use crate::metrics::{percentile::Method, sampling::Traits};
use crate::run::{
    prelude::*,
    record::{NodeValue, Opened, Samples},
    sections::{Extent, Known, Vehicle, needed},
};

/// A record of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    Side(Side),
    Track,
}

impl Source {
    pub fn kind(self) -> RecordKind {
        match self {
            Self::Side(side) => side.kind(),
            Self::Track => RecordKind::Track,
        }
    }
}

/// All values that the search takes from signals.
fn inputs(graph: &Graph) -> impl Iterator<Item = &InputNode> {
    let find = &graph.find;
    find.data.iter().chain(&find.conditions).flatten().chain(&find.prefer)
}

/// The record that a value is taken from.
pub fn source(graph: &Graph, input: &InputNode, own: Side) -> Source {
    match (graph.nodes[input.node].track, input.side) {
        (true, _) => Source::Track,
        (false, InputSide::Own) => Source::Side(own),
        (false, InputSide::Measured) => Source::Side(Side::Measured),
        (false, InputSide::Simulated) => Source::Side(Side::Simulated),
    }
}

/// The nodes that read the columns which the search needs of a record.
pub fn columns(graph: &Graph, of: Source, own: Side) -> Vec<NodeId> {
    let mut seen = BTreeSet::new();
    let mut open: Vec<NodeId> = inputs(graph)
        .filter(|input| source(graph, input, own) == of)
        .map(|input| input.node)
        .collect();
    while let Some(id) = open.pop() {
        if seen.insert(id) {
            open.extend(&graph.nodes[id].inputs);
        }
    }
    seen.retain(|&id| matches!(graph.nodes[id].operation, Operation::Read { .. }));
    seen.into_iter().collect()
}

/// The signal of the whole record that a processed one is made from, and what is done inside the
/// section.
fn peeled(graph: &Graph, mut id: NodeId) -> (NodeId, Vec<Option<&StepSpec>>) {
    let mut inside = Vec::new();
    loop {
        let node = &graph.nodes[id];
        match (&node.operation, node.inputs.first()) {
            (Operation::Cut, Some(&input)) => {
                inside.push(None);
                id = input;
            }
            (Operation::Window(spec), Some(&input)) => {
                inside.push(Some(spec));
                id = input;
            }
            _ => break,
        }
    }
    inside.reverse();
    (id, inside)
}

/// The signals of a piece of a run.
pub struct Signals<'a> {
    graph: &'a Graph,
    own: Side,
    method: Method,
    samples: Vec<(Source, NodeId, Result<Samples, Reason>)>,
    /// What each record covers.
    covered: Vec<(Source, Extent)>,
}

impl<'a> Signals<'a> {
    /// Runs the filters over what the windows hold.
    pub fn of(
        plan: &Plan,
        graph: &'a Graph,
        windows: &Windows,
        own: Side,
        vehicle: &Vehicle,
    ) -> Result<Self, Problems> {
        let method = plan.sections.percentiles;
        let mut signals = Self { graph, own, method, samples: Vec::new(), covered: Vec::new() };
        for (of, window) in &windows.all {
            let (Some(first), last) = (window.first_held(), window.last) else { continue };
            signals.covered.push((*of, (first, last)));
            let mut wanted = BTreeSet::new();
            for input in inputs(graph).filter(|input| source(graph, input, own) == *of) {
                wanted.extend(
                    graph.nodes[input.node]
                        .inputs
                        .iter()
                        .map(|&processed| peeled(graph, processed).0),
                );
            }
            if wanted.is_empty() {
                continue;
            }
            let known = Known::vehicle(vehicle);
            let failed = |reason: Reason| {
                let says = format!("`{}`: {}", window.shown, reason.text());
                Problems::from(Problem::error("find-signal", says))
            };
            let needed = needed(graph, &wanted, &known).map_err(failed)?;
            let opened = Opened::piece(plan, of.kind(), window.columns(), window.first_row);
            let found = opened.evaluate((plan, graph), &needed, &wanted, &known, None);
            let found = found.map_err(failed)?;
            for (id, found) in found {
                let samples = match found {
                    NodeValue::Samples(samples) => Ok(samples),
                    NodeValue::Failed(reason) => Err(reason),
                    NodeValue::Number(..) => Err(Reason::Internal),
                };
                signals.samples.push((*of, id, samples));
            }
        }
        Ok(signals)
    }

    /// The values that an expression takes from the part of the run.
    pub fn values(&self, inputs: &[InputNode], extent: Extent) -> Vec<Result<f64, Reason>> {
        inputs.iter().map(|input| self.value(input, extent)).collect()
    }

    /// Whether every record that the values are taken from covers a part of the run.
    pub fn cover(&self, inputs: &[InputNode], (start, end): Extent) -> bool {
        let covers = |of: Source| {
            self.covered
                .iter()
                .any(|(source, (first, last))| *source == of && *first <= start && *last >= end)
        };
        inputs.iter().all(|input| covers(source(self.graph, input, self.own)))
    }

    fn value(&self, input: &InputNode, extent: Extent) -> Result<f64, Reason> {
        let node = &self.graph.nodes[input.node];
        let Operation::Reduce(reducer) = &node.operation else {
            return Err(Reason::Internal);
        };
        let of = source(self.graph, input, self.own);
        let (base, inside) = peeled(self.graph, node.inputs[0]);
        let samples = self.samples(of, base)?;
        // Cut only: the common case needs no copy.
        if let ([None], 1) = (inside.as_slice(), node.inputs.len()) {
            let range = samples.along.inside(extent);
            if range.is_empty() {
                return Err(Reason::NoSampleInside);
            }
            let value = reducer.run(
                &samples.along.axis[range.clone()],
                &Traits::of(&samples.values[range]),
                self.method,
            );
            return value.filter(|value| value.is_finite()).ok_or(Reason::NoValue);
        }
        let processed = |node: NodeId| -> Result<Samples, Reason> {
            let (base, inside) = peeled(self.graph, node);
            let mut samples = self.samples(of, base)?.clone();
            for step in inside {
                samples = match step {
                    None => samples.cut(extent)?,
                    Some(spec) => samples.windowed(spec, extent, self.method)?,
                };
            }
            Ok(samples)
        };
        let samples = processed(node.inputs[0])?;
        let over = node.inputs.get(1).map(|&over| processed(over)).transpose()?;
        let axis: &Arc<Vec<f64>> = over.as_ref().map_or(&samples.along.axis, |over| &over.values);
        reducer
            .run(axis, &Traits::of(&samples.values), self.method)
            .filter(|value| value.is_finite())
            .ok_or(Reason::NoValue)
    }

    fn samples(&self, of: Source, node: NodeId) -> Result<&Samples, Reason> {
        match self
            .samples
            .iter()
            .find(|(known, id, _)| (*known, *id) == (of, node))
            .map(|(_, _, samples)| samples)
        {
            Some(Ok(samples)) => Ok(samples),
            Some(Err(reason)) => Err(reason.clone()),
            None => Err(Reason::SignalMissing),
        }
    }
}
