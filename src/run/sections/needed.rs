//! The nodes of the graph that a section needs: of the cases of a signal, the one that applies.

use std::collections::BTreeSet;

use super::facts::Known;
use crate::check::evaluate::{flag, words};
use crate::check::plan::Expr;
use crate::graph::{Graph, NodeId, Operation};
use crate::result::Reason;

/// All nodes that the requested ones need in one section; of the cases of a signal, only the one
/// that applies.
pub fn needed(
    graph: &Graph,
    wanted: &BTreeSet<NodeId>,
    known: &Known<'_>,
) -> Result<BTreeSet<NodeId>, Reason> {
    let mut needed = BTreeSet::new();
    let mut open: Vec<NodeId> = wanted.iter().copied().collect();
    while let Some(id) = open.pop() {
        if !needed.insert(id) {
            continue;
        }
        let node = &graph.nodes[id];
        match &node.operation {
            Operation::Select(conditions) => {
                open.push(node.inputs[chosen(conditions, &node.inputs, known)?])
            }
            _ => open.extend(&node.inputs),
        }
    }
    Ok(needed)
}

/// The input of a `Select` that applies in this section.
pub fn chosen(conditions: &[Expr], inputs: &[NodeId], known: &Known<'_>) -> Result<usize, Reason> {
    for (index, condition) in conditions.iter().enumerate() {
        if flag(condition, known)? {
            return Ok(index);
        }
    }
    if inputs.len() > conditions.len() {
        return Ok(inputs.len() - 1);
    }
    Err(Reason::NoCaseOfSignal { expression: conditions.first().map_or(String::new(), words) })
}
