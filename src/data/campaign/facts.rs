//! Facts: what `campaign.yaml` says beyond the layout of the folder. They are printed.

use super::opening::Layout;
use crate::data::cells::name_and_unit;
use crate::source::Span;
use crate::yaml::{Key, Node, Value};

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
pub(super) fn facts(tree: &Node) -> Vec<Fact> {
    let mut facts = Vec::new();
    for (key, node) in
        tree.entries().iter().filter(|(key, _)| !Layout::KEYS.contains(&key.text.as_str()))
    {
        facts.extend(fact("", key, node));
        facts
            .extend(node.entries().iter().filter_map(|(inner, node)| fact(&key.text, inner, node)));
    }
    facts
}

fn fact(group: &str, key: &Key, node: &Node) -> Option<Fact> {
    let text = match &node.value {
        // A short list of scalars reads well in a line; anything deeper is no fact to print.
        Value::List(items) => {
            items.iter().map(Node::scalar_text).collect::<Option<Vec<_>>>()?.join(", ")
        }
        _ => node.scalar_text()?.to_string(),
    };
    let (name, unit) = name_and_unit(&key.text);
    let unit = unit.map(|range| key.text[range].trim().to_string());
    Some(Fact {
        group: group.to_string(),
        name: name.to_string(),
        unit,
        text,
        span: node.span.clone(),
    })
}
