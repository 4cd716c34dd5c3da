//! Shift of the measurement against the simulation along the axis, estimated from the signals.

use std::collections::BTreeSet;

use super::{NodeValues, Offset};
use crate::metrics::synchronise::{self, Estimate, Search};
use crate::run::{
    prelude::*,
    record::{Held, NodeValue},
    sections::Unit,
};

/// Number of steps of the search up to its largest shift.
const STEPS: f64 = 100.0;

/// The filtered signals that are compared: each once, without those that are resampled.
pub fn signals(graph: &Graph, active: &[Vec<bool>]) -> BTreeSet<NodeId> {
    let signals = graph.quantities.iter().zip(active).flat_map(|(quantity, active)| {
        quantity.signals.iter().zip(active).filter(|(_, active)| **active)
    });
    signals.map(|(signal, _)| signal.filtered).collect()
}

/// `None` where the shift cannot be estimated: no signal that both sides have, or none that varies.
pub fn estimate(
    graph: &Graph,
    unit: &Unit,
    farthest: f64,
    simulated: &NodeValues,
    measured: &Held<'_>,
) -> Option<Offset> {
    let (start, end) = unit.extent?;
    let mut pairs = Vec::new();
    let nodes: Vec<NodeId> = simulated.iter().map(|(node, _)| *node).collect();
    for ((node, found), group) in simulated.iter().zip(groups(graph, &nodes)) {
        let (NodeValue::Samples(simulated), Some(measured)) = (found, measured.samples(*node))
        else {
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
