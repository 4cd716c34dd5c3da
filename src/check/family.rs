//! A protocol and those it extends, merged by name into one document.

use std::sync::Arc;

use indexmap::IndexMap;

use crate::problem::{Problem, Problems};
use crate::source::Source;
use crate::syntax;
use crate::syntax::document::{Block, Document, Field};
use crate::syntax::keys;

/// How deep protocols may extend each other.
const DEEPEST: usize = 8;

/// A protocol as merged with its ancestors.
#[derive(Clone, Debug)]
pub struct Family {
    pub merged: Document,
    /// The parent as merged with its own ancestors.
    pub parent: Option<Document>,
    /// The protocol's own text first, then its parent's, and so on.
    pub sources: Vec<Arc<Source>>,
}

/// Finds the text of a protocol by name or path, seen from the text that names it.
pub type Find<'a> = &'a dyn Fn(&str, &Source) -> Result<Arc<Source>, Box<Problem>>;

/// Reads a protocol and its ancestors.
pub fn read(source: &Arc<Source>, find: Find<'_>, problems: &mut Problems) -> Family {
    let mut chain = vec![syntax::read(source, problems)];
    let mut sources = vec![Arc::clone(source)];
    while let Some(field) = chain.last().and_then(|document| extends(document).cloned()) {
        let name = field.value.text.trim().trim_matches('"').to_string();
        if chain.len() > DEEPEST {
            problems
                .push(Problem::error("extends-too-deep", format!("more than {DEEPEST} protocols extend each other")).at(&field.value.span));
            break;
        }
        let from = Arc::clone(&chain[chain.len() - 1].source);
        match find(&name, &from) {
            Ok(found) => {
                if sources.iter().any(|known| known.name == found.name) {
                    problems
                        .push(Problem::error("extends-loop", format!("`{name}` extends itself by way of others")).at(&field.value.span));
                    break;
                }
                chain.push(syntax::read(&found, problems));
                sources.push(found);
            }
            Err(problem) => {
                problems.push(problem.at(&field.value.span));
                break;
            }
        }
    }
    let mut merged: Option<Document> = None;
    let mut parent = None;
    while let Some(document) = chain.pop() {
        merged = Some(match merged {
            None => document,
            Some(before) => {
                let together = merge(&before, &document, problems);
                if chain.is_empty() {
                    parent = Some(before);
                }
                together
            }
        });
    }
    let merged =
        merged.unwrap_or_else(|| Document { source: Arc::clone(source), leading: Vec::new(), blocks: Vec::new(), trailing: Vec::new() });
    Family { merged, parent, sources }
}

fn extends(document: &Document) -> Option<&Field> {
    document.blocks.iter().find(|block| block.kind.text == "protocol").and_then(|block| block.field("extends"))
}

/// The parent's blocks with the variant's put over them: same kind and name means override field by field.
fn merge(parent: &Document, variant: &Document, problems: &mut Problems) -> Document {
    let mut blocks: Vec<Block> = parent.blocks.clone();
    for block in &variant.blocks {
        if block.kind.text == "remove" {
            for field in &block.fields {
                remove(&mut blocks, field, problems);
            }
            continue;
        }
        let same = blocks
            .iter_mut()
            .find(|other| other.kind.text == block.kind.text && (other.name_text() == block.name_text() || block.kind.text == "protocol"));
        match same {
            None => blocks.push(block.clone()),
            Some(_) if block.kind.text == "protocol" => {
                // Who it is, is the variant's own; how records run is inherited unless said.
                let mut own = block.clone();
                if let Some(old) = blocks.iter().find(|other| other.kind.text == "protocol") {
                    for field in old.fields.iter().filter(|field| matches!(field.key.text.as_str(), "axis" | "time" | "edition" | "source"))
                    {
                        if own.field(&field.key.text).is_none() {
                            own.fields.push(field.clone());
                        }
                    }
                }
                if let Some(slot) = blocks.iter_mut().find(|other| other.kind.text == "protocol") {
                    *slot = own;
                }
            }
            Some(other) => overlay(other, block),
        }
    }
    Document { source: Arc::clone(&variant.source), leading: Vec::new(), blocks, trailing: Vec::new() }
}

/// Fields of the variant replace those of the parent with the same key; limits by statistic and scope.
fn overlay(parent: &mut Block, variant: &Block) {
    parent.name.clone_from(&variant.name);
    if variant.title.is_some() {
        parent.title.clone_from(&variant.title);
    }
    let mut replaced: IndexMap<String, Vec<Field>> = IndexMap::new();
    for field in &variant.fields {
        replaced.entry(slot(field)).or_default().push(field.clone());
    }
    // A metric stands in place of value and difference, and the other way round.
    if replaced.contains_key("metric") {
        parent.fields.retain(|field| !matches!(field.key.text.as_str(), "value" | "difference"));
    }
    if replaced.contains_key("value") {
        parent.fields.retain(|field| field.key.text != "metric");
    }
    let mut fields = Vec::new();
    for field in &parent.fields {
        match replaced.get(&slot(field)) {
            None => fields.push(field.clone()),
            Some(_) => {
                if let Some(new) = replaced.shift_remove(&slot(field)) {
                    fields.extend(new);
                }
            }
        }
        // A second field of a replaced slot is dropped with the first.
        fields.dedup_by(|a, b| a.value.span == b.value.span && a.key.span == b.key.span);
    }
    let kept: Vec<String> = variant.fields.iter().map(slot).collect();
    fields.retain(|field| !kept.contains(&slot(field)) || variant.fields.iter().any(|own| own.value.span == field.value.span));
    for (_, new) in replaced {
        fields.extend(new);
    }
    parent.fields = fields;
}

/// What a field is overridden by: its key; for a limit also its statistic and zones.
fn slot(field: &Field) -> String {
    if field.key.text != "limit" {
        return field.key.text.clone();
    }
    let words: Vec<&str> = field.value.text.split_whitespace().collect();
    let scope = words.iter().position(|word| *word == "for").map_or(String::new(), |at| words[at..].join(" "));
    format!("limit {} {scope}", words.first().unwrap_or(&""))
}

fn remove(blocks: &mut Vec<Block>, field: &Field, problems: &mut Problems) {
    let words: Vec<&str> = field.value.text.split_whitespace().collect();
    let (kind, name) = match (field.key.text.as_str(), words.as_slice()) {
        ("limit", [quantity, ..]) => ("quantity", *quantity),
        (kind, [name, ..]) => (kind, *name),
        _ => return,
    };
    let Some(index) = blocks.iter().position(|block| block.kind.text == kind && block.name_text() == name) else {
        let known: Vec<&str> = blocks.iter().filter(|block| block.kind.text == kind).map(Block::name_text).collect();
        problems.push(
            Problem::error("nothing-to-remove", format!("the parent has no {kind} `{name}`")).at(&field.value.span).suggest(name, known),
        );
        return;
    };
    if field.key.text != "limit" {
        blocks.remove(index);
        return;
    }
    let statistic = words.get(1).copied().unwrap_or("");
    let before = blocks[index].fields.len();
    blocks[index].fields.retain(|field| field.key.text != "limit" || field.value.text.split_whitespace().next() != Some(statistic));
    if blocks[index].fields.len() == before {
        problems.push(
            Problem::error("nothing-to-remove", format!("`{name}` has no limit of `{statistic}`"))
                .at(&field.value.span)
                .help("write the quantity, then the statistic: `limit az_max mean`"),
        );
    }
}

/// The kinds whose blocks are compared by name in [`super::diff`].
pub fn kinds() -> impl Iterator<Item = &'static keys::Kind> {
    keys::KINDS.iter()
}
