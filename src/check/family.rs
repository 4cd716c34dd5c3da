//! A protocol and the protocols it extends, merged by name into one document.

use std::sync::Arc;

use super::like;
use super::overlay::overlay;
use super::prelude::*;
use crate::source::Source;
use crate::syntax;
use crate::syntax::families::Known;
use crate::syntax::phrase::Limit;
use crate::syntax::{families, keys};

/// Written in `remove` in place of a name: all blocks of the kind.
const EVERY: &str = "every";
/// Largest number of protocols that extend each other in a chain.
const DEEPEST: usize = 8;

/// A protocol merged with its ancestors.
#[derive(Clone, Debug)]
pub struct Family {
    pub merged: Document,
    /// The parent, merged with its own ancestors.
    pub parent: Option<Document>,
    /// The text of the protocol first, then that of its parent, and so on.
    pub sources: Vec<Arc<Source>>,
    /// Whether every ancestor was found and every family of blocks could be expanded. If not, names
    /// may be missing and are not reported as unknown.
    pub whole: bool,
}

/// Finds the text of a protocol by name or path, relative to the text that names it.
pub type Find<'a> = &'a dyn Fn(&str, &Source) -> Result<Arc<Source>, Problem>;

/// Reads a protocol and its ancestors.
pub fn read(source: &Arc<Source>, find: Find<'_>, problems: &mut Problems) -> Family {
    let mut chain = vec![syntax::read(source, problems)];
    let mut sources = vec![Arc::clone(source)];
    let mut whole = true;
    while let Some(field) = chain.last().and_then(|document| extends(document).cloned()) {
        let name = field.value.text.trim().trim_matches('"').to_string();
        if chain.len() > DEEPEST {
            problems.push(problem!(
                "extends-too-deep",
                &field,
                "more than {DEEPEST} protocols extend each other"
            ));
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
                        format!("`{name}` extends this protocol again")
                    };
                    problems.push(error("extends-loop", says, &field));
                    whole = false;
                    break;
                }
                chain.push(syntax::read(&found, problems));
                sources.push(found);
            }
            Err(problem) => {
                problems.push(problem.at(&field));
                whole = false;
                break;
            }
        }
    }
    let mut merged: Option<Document> = None;
    let mut parent: Option<Document> = None;
    let mut known = Vec::new();
    while let Some(written) = chain.pop() {
        let left =
            merged.as_ref().map(|before| without_removed(before, &written, &known, problems));
        let (document, sound) = families::expand(&written, left.as_ref(), &mut known, problems);
        whole &= sound;
        let together = left.map_or_else(|| document.clone(), |left| merge(left, &document));
        if let Some(before) = merged.replace(together).filter(|_| chain.is_empty()) {
            parent = Some(before);
        }
    }
    let mut merged = merged.unwrap_or_else(|| Document::empty(source));
    like::write_out(&mut merged, whole, problems);
    if let Some(parent) = &mut parent {
        // What is wrong in it was told above.
        like::write_out(parent, false, &mut Problems::default());
    }
    Family { merged, parent, sources, whole }
}

fn extends(document: &Document) -> Option<&Field> {
    document
        .blocks
        .iter()
        .find(|block| block.kind.text == "protocol")
        .and_then(|block| block.field("extends"))
}

/// The parent without the blocks that the variant removes. Blocks of the variant are not in it yet,
/// so `remove` only concerns the parent.
fn without_removed(
    parent: &Document,
    variant: &Document,
    families: &[Known],
    problems: &mut Problems,
) -> Document {
    let mut left = parent.clone();
    let removals = || {
        variant
            .blocks
            .iter()
            .filter(|block| block.kind.text == "remove")
            .flat_map(|block| &block.fields)
    };
    let every = |field: &Field| words(field).first() == Some(&EVERY);
    // Single names are removed before `every`, and limits before their quantities. Otherwise they
    // would be reported as removed already.
    let mut fields: Vec<&Field> = removals().collect();
    fields.sort_by_key(|field| (every(field), field.key.text != "limit"));
    for field in fields {
        remove(&mut left.blocks, field, families, problems);
    }
    left
}

/// The blocks of the parent, overridden field by field by blocks of the variant with the same kind
/// and name.
fn merge(parent: Document, variant: &Document) -> Document {
    let mut blocks = parent.blocks;
    for block in variant.blocks.iter().filter(|block| block.kind.text != "remove") {
        let single = keys::of_block(block).is_some_and(|kind| kind.single);
        let same = |other: &&mut Block| {
            let both = other.kind.text == block.kind.text
                && keys::of_block(other).is_some_and(|kind| kind.single) == single;
            both && (single || other.name_text() == block.name_text())
        };
        match blocks.iter_mut().find(same) {
            None => blocks.push(block.clone()),
            Some(old) if block.kind.text == "protocol" => *old = succeed(old, block),
            Some(old) => overlay(old, block),
        }
    }
    Document { blocks, ..Document::empty(&variant.source) }
}

/// The protocol block of the variant. Axis, time, edition and source are inherited unless the
/// variant states them.
fn succeed(parent: &Block, variant: &Block) -> Block {
    let mut own = variant.clone();
    for field in parent
        .fields
        .iter()
        .filter(|field| matches!(field.key.text.as_str(), "axis" | "time" | "edition" | "source"))
    {
        if own.field(&field.key.text).is_none() {
            own.fields.push(field.clone());
        }
    }
    own
}

fn words(field: &Field) -> Vec<&str> {
    field.value.text.split_whitespace().collect()
}

/// Removes what a field of `remove` names: a block, a family of blocks, or all of its kind; or
/// limits of these.
fn remove(blocks: &mut Vec<Block>, field: &Field, families: &[Known], problems: &mut Problems) {
    let words = words(field);
    let is_limit = field.key.text == "limit";
    let (kind, name) = (
        if is_limit { "quantity" } else { field.key.text.as_str() },
        words.first().copied().unwrap_or(""),
    );
    let family = families.iter().find(|family| family.kind == kind && family.name == name);
    let meant = |block: &Block| {
        let named = || {
            block.name_text() == name
                || family
                    .is_some_and(|family| family.members.iter().any(|one| one == block.name_text()))
        };
        // The verdict without a name cannot be removed.
        block.kind.text == kind && block.name.is_some() && (name == EVERY || named())
    };
    if !blocks.iter().any(meant) {
        let says = if name == EVERY {
            format!("the parent has no {kind}")
        } else {
            format!("the parent has no {kind} called `{name}`")
        };
        let mut known: Vec<&str> = blocks
            .iter()
            .filter(|block| block.kind.text == kind && block.name.is_some())
            .map(Block::name_text)
            .collect();
        let here = families.iter().filter(|family| {
            family.kind == kind && family.members.iter().any(|one| known.contains(&one.as_str()))
        });
        let here: Vec<&str> = here.map(|family| family.name.as_str()).collect();
        known.extend(here);
        problems.push(error("nothing-to-remove", says, field).suggest(name, known));
        return;
    }
    match (is_limit, words.as_slice()) {
        (false, [_]) => blocks.retain(|block| !meant(block)),
        (true, [_, limit @ ..]) => remove_limits(
            blocks.iter_mut().filter(|block| meant(block)),
            name,
            limit,
            field,
            problems,
        ),
        _ => {
            problems.push(
                problem!("remove", field, "`remove` needs the name of one {}", field.key.text)
                    .help("write one name on each line, or `every` for all"),
            );
        }
    }
}

/// Removes limits from quantities: those of a statistic and scope, or all.
fn remove_limits<'a>(
    quantities: impl Iterator<Item = &'a mut Block>,
    name: &str,
    words: &[&str],
    field: &Field,
    problems: &mut Problems,
) {
    // The estimate of a limit may have several words, in parentheses; a scope may follow it.
    let wanted = words.join(" ");
    let quiet = Problems::default;
    let written = Text { text: wanted.clone(), span: field.value.span.clone(), exact: false };
    let written = from_pest::minimum(&written, &mut quiet());
    let is_wanted = |other: &Field| {
        let limit = from_pest::limit(&other.value, &mut quiet());
        let same = |limit: &Limit| {
            limit.statistic.node == wanted
                || written.as_ref().is_some_and(|written| {
                    !written.scope.is_all()
                        && (&written.count, &written.scope) == (&limit.estimate, &limit.scope)
                })
        };
        words.is_empty() || limit.as_ref().is_some_and(same)
    };
    let mut removed = false;
    let mut known: Vec<String> = Vec::new();
    for quantity in quantities {
        let of = |field: &Field| {
            from_pest::limit(&field.value, &mut Problems::default())
                .map(|limit| limit.statistic.node)
        };
        known.extend(quantity.fields_named("limit").filter_map(of));
        let before = quantity.fields.len();
        quantity.fields.retain(|other| other.key.text != "limit" || !is_wanted(other));
        removed |= quantity.fields.len() < before;
    }
    if removed {
        return;
    }
    let of = if name == EVERY {
        "no quantity of the parent has".to_owned()
    } else {
        format!("`{name}` of the parent has no limit")
    };
    let says = match (name == EVERY, words) {
        (true, []) => format!("{of} a limit"),
        (true, _) => format!("{of} a limit of the `{}`", words.join(" ")),
        (false, []) => of,
        (false, _) => format!("{of} of the `{}`", words.join(" ")),
    };
    known.dedup();
    problems.push(error("nothing-to-remove", says, field).suggest(&words.join(" "), &known));
}
