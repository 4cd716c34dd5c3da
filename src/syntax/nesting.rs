//! Keys of the YAML form that are indented too much or too little, and their correct place.

use super::keys::{KINDS, Kind};
use crate::yaml::{Node, Value};

/// The kind of a key of the protocol, if its content agrees with that kind.
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

/// A key of the protocol among names or fields.
pub fn too_deep(name: &str, node: &Node) -> Option<String> {
    group(name, node).map(|kind| {
        format!("`{}` is a key of the protocol: write it without indentation", kind.group)
    })
}

/// A block among the fields of another block of its kind.
pub fn block_among_fields(
    kind: &Kind,
    name: &str,
    node: &Node,
    block: Option<&str>,
) -> Option<String> {
    let fields = matches!(node.value, Value::Map(_))
        && node.entries().iter().any(|(key, _)| is_field(kind, &key.text));
    let block = block.filter(|_| fields && !kind.single)?;
    Some(format!(
        "`{name}` has fields of a `{}`: as a separate block, it needs the indentation of `{block}`",
        kind.word
    ))
}

/// A block without indentation, which should be below the key of its kind.
pub fn block_at_margin(name: &str, node: &Node) -> Option<String> {
    let entries = node.entries();
    let fits =
        |kind: &&Kind| !kind.single && entries.iter().all(|(key, _)| is_field(kind, &key.text));
    let kind = KINDS.iter().filter(|_| !entries.is_empty()).find(fits)?;
    // Fields that several kinds have do not show which kind is meant.
    let only = KINDS.iter().filter(fits).count() == 1;
    Some(match only {
        true => {
            format!("`{name}` has fields of a `{}`: indent it below `{}`", kind.word, kind.group)
        }
        false => format!(
            "`{name}` has fields: indent it below the key of its kind, such as `{}`",
            kind.group
        ),
    })
}

/// A field among the names of blocks.
pub fn field_among_names(kind: &Kind, name: &str) -> Option<String> {
    is_field(kind, name).then(|| {
        format!("`{name}` is a field of a `{}`: indent it below the name of its block", kind.word)
    })
}

/// A field below another field.
pub fn field_below_field(kind: &Kind, field: &str, node: &Node) -> Option<String> {
    let (inner, _) = node.entries().iter().find(|(key, _)| is_field(kind, &key.text))?;
    Some(format!(
        "`{}` is a field of a `{}`: it needs the indentation of `{field}`",
        inner.text, kind.word
    ))
}
