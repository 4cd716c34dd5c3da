//! The graph as text, DOT and JSON.

use std::fmt::Write;

use super::{Graph, Node};

/// One line for each node: index, stage, words, inputs, unit, and the line of the protocol.
pub fn text(graph: &Graph) -> String {
    let mut out = String::new();
    for (id, node) in graph.nodes.iter().enumerate() {
        let inputs = if node.inputs.is_empty() {
            String::new()
        } else {
            format!(
                " <- {}",
                node.inputs.iter().map(|id| format!("n{id}")).collect::<Vec<_>>().join(" ")
            )
        };
        // Writing to a String cannot fail.
        let _ = writeln!(
            out,
            "n{id:<4} {:<9} {} [{}]{inputs}  ({})",
            node.operation.stage().in_words(),
            node.label.text,
            node.dimension,
            place(node)
        );
    }
    out
}

/// Graphviz DOT, with one cluster for each stage.
pub fn dot(graph: &Graph) -> String {
    let mut out = String::from(
        "digraph protocol {\n  rankdir=LR;\n  node [shape=box, fontname=\"sans-serif\"];\n",
    );
    for (id, node) in graph.nodes.iter().enumerate() {
        let label = format!(
            "{}\\n{}",
            node.operation.stage().in_words(),
            node.label.text.replace('\\', "\\\\").replace('"', "\\\"")
        );
        let _ = writeln!(out, "  n{id} [label=\"{label}\"];");
    }
    for (id, node) in graph.nodes.iter().enumerate() {
        for input in &node.inputs {
            let _ = writeln!(out, "  n{input} -> n{id};");
        }
    }
    out.push_str("}\n");
    out
}

pub fn json(graph: &Graph) -> serde_json::Value {
    let nodes: Vec<serde_json::Value> = graph
        .nodes
        .iter()
        .enumerate()
        .map(|(id, node)| {
            let (line, column) = node.from.source.line_column(node.from.start);
            serde_json::json!({
                "id": id,
                "stage": node.operation.stage().in_words(),
                "does": node.label.text,
                "inputs": node.inputs,
                "dimension": node.dimension.to_string(),
                "from": {"file": node.from.source.name, "line": line, "column": column},
            })
        })
        .collect();
    let mut json = serde_json::json!({ "nodes": nodes, "verdict": graph.verdicts[0] });
    if graph.verdicts.len() > 1 {
        json["verdicts"] = serde_json::json!(graph.verdicts);
    }
    json
}

fn place(node: &Node) -> String {
    format!("{}:{}", node.from.source.name, node.from.line())
}
