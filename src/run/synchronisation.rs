//! The measurement against the simulation along the axis: shifts asked for, and the one the signals themselves show.

use std::collections::BTreeSet;

use super::record::{Found, Held, Work};
use super::sections::Unit;
use super::sides::Evaluated;
use crate::graph::{Graph, NodeId, Operation};
use crate::metrics::synchronise::{self, Estimate, Search};

/// Where to evaluate the measurement.
#[derive(Clone, Copy, Debug)]
pub struct Shifts<'a> {
    /// What is added to the measurement's axis before sections are cut, SI.
    pub offsets: &'a [f64],
    /// Farthest shift looked for where each section's own is to be estimated, SI.
    pub farthest: Option<f64>,
    /// Whether what was estimated is added, too.
    pub correct: bool,
}

impl Shifts<'_> {
    /// The records as they are.
    pub const NONE: Shifts<'static> = Shifts { offsets: &[0.0], farthest: None, correct: false };

    pub fn plain(&self) -> bool {
        self.offsets == [0.0] && self.farthest.is_none()
    }
}

/// What would bring a section's measurement onto its simulation, in SI of the axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Offset {
    pub shift: f64,
    /// 95 % interval.
    pub low: f64,
    pub high: f64,
    /// Correlation of both at that shift, all signals together.
    pub correlation: f64,
}

/// Steps of the search up to its farthest shift.
const STEPS: f64 = 100.0;

/// The filtered signals that are compared: each once, none that is resampled on the way.
pub fn signals(work: &Work<'_>, active: &[Vec<bool>]) -> BTreeSet<NodeId> {
    let mut found = BTreeSet::new();
    for (index, quantity) in work.graph.quantities.iter().enumerate() {
        for (number, signal) in quantity.signals.iter().enumerate() {
            if active[index][number] {
                found.insert(signal.filtered);
            }
        }
    }
    found
}

/// `None` where the records do not tell: no signal of both, or none that varies.
pub fn estimate(graph: &Graph, unit: &Unit, farthest: f64, simulated: &Evaluated, measured: &Held<'_>) -> Option<Offset> {
    let (start, end) = unit.extent?;
    let mut pairs = Vec::new();
    let nodes: Vec<NodeId> = simulated.iter().map(|(node, _)| *node).collect();
    for ((node, found), group) in simulated.iter().zip(groups(graph, &nodes)) {
        let (Found::Samples(simulated), Some(measured)) = (found, measured.samples(*node)) else { continue };
        pairs.push(synchronise::Pair {
            simulated: (&simulated.along.axis, &simulated.values),
            measured: (&measured.along.axis, &measured.values),
            group,
        });
    }
    let search = Search { start, end, farthest, step: farthest / STEPS };
    let Estimate { shift, low, high, correlation } = synchronise::estimate(&pairs, &search)?;
    Some(Offset { shift, low, high, correlation })
}

/// A number for each signal, the same for signals that share a channel, directly or through others.
fn groups(graph: &Graph, nodes: &[NodeId]) -> Vec<usize> {
    let mut group: Vec<usize> = (0..nodes.len()).collect();
    let mut seen: Vec<(NodeId, usize)> = Vec::new();
    for (at, node) in nodes.iter().enumerate() {
        for channel in channels(graph, *node) {
            let Some((_, other)) = seen.iter().find(|(known, _)| *known == channel) else {
                seen.push((channel, at));
                continue;
            };
            let (mine, others) = (group[at], group[*other]);
            group.iter_mut().filter(|group| **group == mine).for_each(|group| *group = others);
        }
    }
    group
}

/// The nodes that read what a signal is made of.
fn channels(graph: &Graph, node: NodeId) -> BTreeSet<NodeId> {
    let node_is = &graph.nodes[node];
    if matches!(node_is.operation, Operation::Read { .. }) {
        return BTreeSet::from([node]);
    }
    node_is.inputs.iter().flat_map(|input| channels(graph, *input)).collect()
}
