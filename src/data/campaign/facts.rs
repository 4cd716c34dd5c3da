//! Facts: what `campaign.yaml` says beyond the layout of the folder. They are printed.

use super::layout::Layout;
use crate::data::{cells::name_and_unit_text, prelude::*};

/// Something that `campaign.yaml` says beyond the layout.
#[derive(Clone, Debug, PartialEq)]
pub struct Fact {
    /// The key of the map that it stands in; empty at the top.
    pub group: String,
    /// The key without its unit.
    pub name: String,
    /// What stood in brackets after the name.
    pub unit: Option<String>,
    /// As written.
    pub text: String,
    pub span: Span,
}

/// Scalars at the top and one map below it, in the order written.
pub fn facts(tree: &Node) -> Vec<Fact> {
    let free = |(key, _): &&(Key, Node)| !Layout::KEYS.contains(&key.text.as_str());
    let below = |(key, node): &(Key, Node)| {
        let inner = node.entries().iter().filter_map(|(inner, node)| fact(&key.text, inner, node));
        fact("", key, node).into_iter().chain(inner).collect::<Vec<_>>()
    };
    tree.entries().iter().filter(free).flat_map(below).collect()
}

fn fact(group: &str, key: &Key, node: &Node) -> Option<Fact> {
    let text = match &node.value {
        // A short list of scalars reads well in a line; anything deeper is no fact to print.
        Value::List(items) => {
            items.iter().map(Node::scalar_text).collect::<Option<Vec<_>>>()?.join(", ")
        }
        _ => node.scalar_text()?.to_string(),
    };
    let (name, unit) = name_and_unit_text(&key.text);
    Some(Fact { group: group.to_string(), name, unit, text, span: node.span.clone() })
}
