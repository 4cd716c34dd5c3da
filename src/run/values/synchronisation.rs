//! Shift of the measurement against the simulation along the axis: requested shifts, and the shift
//! estimated from the signals.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::sides::Evaluated;
use crate::graph::{Graph, NodeId, Operation};
use crate::metrics::synchronise::{self, Estimate, Search};
use crate::run::record::{Found, Held, Work};
use crate::run::sections::Unit;

/// The shifts at which the measurement is evaluated.
#[derive(Clone, Copy, Debug)]
pub struct Shifts<'a> {
    /// Added to the measurement's axis before sections are cut, SI.
    pub offsets: &'a [f64],
    /// Largest shift of the search, where the shift of each section is to be estimated, SI.
    pub farthest: Option<f64>,
    /// Whether the estimated shift is added as well.
    pub correct: bool,
}

impl Shifts<'_> {
    /// The records without a shift.
    pub const NONE: Shifts<'static> = Shifts { offsets: &[0.0], farthest: None, correct: false };

    pub fn plain(&self) -> bool {
        self.offsets == [0.0] && self.farthest.is_none()
    }
}

/// The shift that aligns a section's measurement with its simulation, in SI of the axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Offset {
    pub shift: f64,
    /// 95 % interval.
    pub low: f64,
    pub high: f64,
    /// Correlation of both sides at that shift, over all signals.
    pub correlation: f64,
}

/// Number of steps of the search up to its largest shift.
const STEPS: f64 = 100.0;

/// The filtered signals that are compared: each once, without those that are resampled.
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

/// `None` where the shift cannot be estimated: no signal that both sides have, or none that varies.
pub fn estimate(
    graph: &Graph,
    unit: &Unit,
    farthest: f64,
    simulated: &Evaluated,
    measured: &Held<'_>,
) -> Option<Offset> {
    let (start, end) = unit.extent?;
    let mut pairs = Vec::new();
    let nodes: Vec<NodeId> = simulated.iter().map(|(node, _)| *node).collect();
    for ((node, found), group) in simulated.iter().zip(groups(graph, &nodes)) {
        let (Found::Samples(simulated), Some(measured)) = (found, measured.samples(*node)) else {
            continue;
        };
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

/// A group index for each signal; signals that share a channel, directly or through others, are in
/// the same group.
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

/// The nodes that read the channels of a signal.
fn channels(graph: &Graph, node: NodeId) -> BTreeSet<NodeId> {
    let node_is = &graph.nodes[node];
    if matches!(node_is.operation, Operation::Read { .. }) {
        return BTreeSet::from([node]);
    }
    node_is.inputs.iter().flat_map(|input| channels(graph, *input)).collect()
}
