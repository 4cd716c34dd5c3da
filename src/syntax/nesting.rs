//! Keys of the YAML form that stand a level too deep or not deep enough: where they belong.

use super::keys::{KINDS, Kind};
use crate::yaml::{Node, Value};

/// The kind whose key of the protocol this is, with below it what that kind holds.
fn group(name: &str, node: &Node) -> Option<&'static Kind> {
    let kind = KINDS.iter().find(|kind| kind.group == name)?;
    let entries = node.entries();
    let holds = if kind.single {
        entries.iter().any(|(key, _)| is_field(kind, &key.text))
    } else {
        !entries.is_empty() && entries.iter().all(|(_, node)| matches!(node.value, Value::Map(_)))
    };
    holds.then_some(kind)
}

fn is_field(kind: &Kind, name: &str) -> bool {
    kind.key(name).is_some() || name == "title"
}

/// A key of the protocol that stands among names or fields.
pub fn too_deep(name: &str, node: &Node) -> Option<String> {
    group(name, node).map(|kind| format!("`{}` is a key of the protocol: it stands at the left margin", kind.group))
}

/// A block that stands among the fields of another one of its kind.
pub fn block_among_fields(kind: &Kind, name: &str, node: &Node, block: Option<&str>) -> Option<String> {
    let fields = matches!(node.value, Value::Map(_)) && node.entries().iter().any(|(key, _)| is_field(kind, &key.text));
    let block = block.filter(|_| fields && !kind.single)?;
    Some(format!("`{name}` holds fields of a `{}`: as a block of its own it stands as far left as `{block}`", kind.word))
}

/// A block that stands at the left margin, below the key of its kind or not.
pub fn block_at_margin(name: &str, node: &Node) -> Option<String> {
    let entries = node.entries();
    let fits = |kind: &&Kind| !kind.single && entries.iter().all(|(key, _)| is_field(kind, &key.text));
    let kind = KINDS.iter().filter(|_| !entries.is_empty()).find(fits)?;
    // Fields that several kinds have say little of which one is meant.
    let only = KINDS.iter().filter(fits).count() == 1;
    Some(match only {
        true => format!("`{name}` holds fields of a `{}`: it stands below `{}`, indented", kind.word, kind.group),
        false => format!("`{name}` holds fields: it stands below the key of its kind, such as `{}`, indented", kind.group),
    })
}

/// A field that stands among the names of blocks.
pub fn field_among_names(kind: &Kind, name: &str) -> Option<String> {
    is_field(kind, name).then(|| format!("`{name}` is a field of a `{}`: it stands below the name of its block, indented", kind.word))
}

/// A field that stands below another field.
pub fn field_below_field(kind: &Kind, field: &str, node: &Node) -> Option<String> {
    let (inner, _) = node.entries().iter().find(|(key, _)| is_field(kind, &key.text))?;
    Some(format!("`{}` is a field of a `{}`: it stands as far left as `{field}`", inner.text, kind.word))
}
