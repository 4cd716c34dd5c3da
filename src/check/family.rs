//! A protocol and those it extends, merged by name into one document.

use std::sync::Arc;

use indexmap::IndexMap;

use crate::problem::{Problem, Problems};
use crate::source::Source;
use crate::syntax;
use crate::syntax::document::{Block, Document, Field};
use crate::syntax::{from_pest, keys};

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
    /// Whether every ancestor was found: if not, nothing can be told of names that may stand in it.
    pub whole: bool,
}

/// Finds the text of a protocol by name or path, seen from the text that names it.
pub type Find<'a> = &'a dyn Fn(&str, &Source) -> Result<Arc<Source>, Box<Problem>>;

/// Reads a protocol and its ancestors.
pub fn read(source: &Arc<Source>, find: Find<'_>, problems: &mut Problems) -> Family {
    let mut chain = vec![syntax::read(source, problems)];
    let mut sources = vec![Arc::clone(source)];
    let mut whole = true;
    while let Some(field) = chain.last().and_then(|document| extends(document).cloned()) {
        let name = field.value.text.trim().trim_matches('"').to_string();
        if chain.len() > DEEPEST {
            problems
                .push(Problem::error("extends-too-deep", format!("more than {DEEPEST} protocols extend each other")).at(&field.value.span));
            whole = false;
            break;
        }
        let from = Arc::clone(&chain[chain.len() - 1].source);
        match find(&name, &from) {
            Ok(found) => {
                if sources.iter().any(|known| known.name == found.name) {
                    let says = if chain.len() == 1 {
                        "this protocol extends itself".into()
                    } else {
                        format!("`{name}` extends this protocol in turn")
                    };
                    problems.push(Problem::error("extends-loop", says).at(&field.value.span));
                    whole = false;
                    break;
                }
                chain.push(syntax::read(&found, problems));
                sources.push(found);
            }
            Err(problem) => {
                problems.push(problem.at(&field.value.span));
                whole = false;
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
    Family { merged, parent, sources, whole }
}

fn extends(document: &Document) -> Option<&Field> {
    document.blocks.iter().find(|block| block.kind.text == "protocol").and_then(|block| block.field("extends"))
}

/// The parent's blocks with the variant's put over them: same kind and name means override field by field.
fn merge(parent: &Document, variant: &Document, problems: &mut Problems) -> Document {
    let mut blocks: Vec<Block> = parent.blocks.clone();
    // Before anything is added, so that what is removed is the parent's wherever `remove` stands.
    for field in variant.blocks.iter().filter(|block| block.kind.text == "remove").flat_map(|block| &block.fields) {
        remove(&mut blocks, field, problems);
    }
    for block in variant.blocks.iter().filter(|block| block.kind.text != "remove") {
        let single = keys::kind(&block.kind.text).is_some_and(|kind| kind.single);
        let same = |other: &&mut Block| other.kind.text == block.kind.text && (single || other.name_text() == block.name_text());
        match blocks.iter_mut().find(same) {
            None => blocks.push(block.clone()),
            Some(old) if block.kind.text == "protocol" => *old = succeed(old, block),
            Some(old) => overlay(old, block),
        }
    }
    Document { source: Arc::clone(&variant.source), leading: Vec::new(), blocks, trailing: Vec::new() }
}

/// Who a protocol is, is the variant's own; how records run and what standard it follows are inherited unless said.
fn succeed(parent: &Block, variant: &Block) -> Block {
    let mut own = variant.clone();
    for field in parent.fields.iter().filter(|field| matches!(field.key.text.as_str(), "axis" | "time" | "edition" | "source")) {
        if own.field(&field.key.text).is_none() {
            own.fields.push(field.clone());
        }
    }
    own
}

/// Fields of the variant in place of those of the parent with the same slot; the rest stays.
fn overlay(parent: &mut Block, variant: &Block) {
    parent.name.clone_from(&variant.name);
    if variant.title.is_some() {
        parent.title.clone_from(&variant.title);
    }
    let says = |key: &str| variant.field(key).is_some();
    let replaced = |field: &Field| match field.key.text.as_str() {
        // A metric stands in place of value and difference, a number's unit in place of words, and the other way round.
        "value" | "difference" => says("metric"),
        "metric" => says("value") || says("difference"),
        "in" => says("one of"),
        "one of" => says("in"),
        _ => false,
    };
    let mut new: IndexMap<String, Vec<Field>> = IndexMap::new();
    for field in &variant.fields {
        new.entry(slot(field)).or_default().push(field.clone());
    }
    let taken: Vec<String> = new.keys().cloned().collect();
    let mut fields = Vec::new();
    for field in parent.fields.drain(..) {
        let slot = slot(&field);
        // The first of a slot makes room for all of the variant's, so that they stand where the author of the parent had them.
        fields.extend(new.shift_remove(&slot).unwrap_or_default());
        if !taken.contains(&slot) && !replaced(&field) {
            fields.push(field);
        }
    }
    fields.extend(new.into_values().flatten());
    parent.fields = fields;
}

/// What a field is overridden by: its key; for a limit also what it bounds and where.
pub(super) fn slot(field: &Field) -> String {
    if field.key.text != "limit" {
        return field.key.text.clone();
    }
    match from_pest::limit(&field.value, &mut Problems::default()) {
        Some(limit) => format!("limit {} {}", limit.bounds(), limit.scope.node.meaning()),
        None => format!("limit {}", field.value.text),
    }
}

fn remove(blocks: &mut Vec<Block>, field: &Field, problems: &mut Problems) {
    let words: Vec<&str> = field.value.text.split_whitespace().collect();
    let is_limit = field.key.text == "limit";
    let (kind, name) = (if is_limit { "quantity" } else { field.key.text.as_str() }, words.first().copied().unwrap_or(""));
    let Some(index) = blocks.iter().position(|block| block.kind.text == kind && block.name_text() == name) else {
        let known: Vec<&str> = blocks.iter().filter(|block| block.kind.text == kind).map(Block::name_text).collect();
        let problem = Problem::error("nothing-to-remove", format!("the parent has no {kind} `{name}`")).at(&field.value.span);
        problems.push(problem.suggest(name, known));
        return;
    };
    match (is_limit, words.as_slice()) {
        (false, [_]) => drop(blocks.remove(index)),
        (true, [_, statistic, scope @ ..]) => {
            let wanted = |other: &Field| {
                let limit = from_pest::limit(&other.value, &mut Problems::default());
                let same = limit.is_some_and(|limit| {
                    limit.statistic.node == *statistic && (scope.is_empty() || limit.scope.node.meaning() == scope.join(" "))
                });
                other.key.text == "limit" && same
            };
            let before = blocks[index].fields.len();
            blocks[index].fields.retain(|field| !wanted(field));
            if blocks[index].fields.len() == before {
                let known: Vec<&str> =
                    blocks[index].fields_named("limit").filter_map(|limit| limit.value.text.split_whitespace().next()).collect();
                let says = format!("`{name}` of the parent has no limit of the `{}`", words[1..].join(" "));
                problems.push(Problem::error("nothing-to-remove", says).at(&field.value.span).suggest(statistic, known));
            }
        }
        _ => {
            let problem = Problem::error("remove", format!("what is to be removed is one {}", field.key.text)).at(&field.value.span);
            problems.push(problem.help(if is_limit {
                "write the quantity, then the statistic: `limit <quantity> mean`"
            } else {
                "write one name in each line"
            }));
        }
    }
}
