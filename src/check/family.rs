//! A protocol and the protocols it extends, merged by name into one document.

use std::sync::Arc;

use super::{like, overlay::overlay, prelude::*};
use crate::source::Source;
use crate::syntax::{
    self,
    families::{self, Known},
    keys,
    phrase::Limit,
};

/// The fields of the head that name other texts.
const EXTENDS: &str = "extends";
const USES: &str = "uses";
/// Written in `remove` in place of a name: all blocks of the kind.
const EVERY: &str = "every";
/// Largest number of protocols that extend each other in a chain.
const DEEPEST: usize = 8;

/// A protocol merged with its ancestors.
#[derive(Clone, Debug)]
pub struct Family {
    pub merged: Document,
    /// The parent first, then its parent, and so on.
    pub ancestors: Vec<Ancestor>,
    /// The text of the protocol first, then those whose rules it uses, then those of its parent in
    /// the same order, and so on.
    pub sources: Vec<Arc<Source>>,
    /// The name that each of them gives itself, if it gives one.
    pub names: Vec<Option<Text>>,
    /// Whether every text was found. If not, any name may be missing.
    pub whole: bool,
    /// The names, as written, of families of blocks that could not be expanded.
    pub lost: Vec<String>,
}

/// Problems of a rule by itself, whatever else the protocol has.
const BY_ITSELF: [&str; 8] = [
    "syntax",
    "unknown-unit",
    "unit-mismatch",
    "decimal-comma",
    "unknown-function",
    "arguments",
    "ambiguous",
    "not-finite",
];

/// A protocol that is extended.
#[derive(Clone, Debug)]
pub struct Ancestor {
    /// Merged with its own ancestors.
    pub merged: Document,
    /// Where its texts begin in [`Family::sources`].
    pub from: usize,
}

impl Family {
    /// The text of the protocol and of those that it extends, without those whose rules it uses.
    pub fn extended(&self) -> impl Iterator<Item = &Arc<Source>> {
        let from = self.ancestors.iter().map(|ancestor| ancestor.from);
        std::iter::once(0).chain(from).filter_map(|at| self.sources.get(at))
    }

    /// Whether a problem of the rules is one although texts or families are missing: it does not
    /// follow from that.
    pub fn may_tell(&self, problem: &Problem) -> bool {
        if BY_ITSELF.contains(&problem.code) {
            return true;
        }
        let at = problem.at.as_ref().map_or("", |at| at.text());
        let of_name = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.');
        let mut words =
            [at, &problem.says].into_iter().flat_map(|text| text.split(|c: char| !of_name(c)));
        let lost = |word: &str| self.lost.iter().any(|family| may_be_of(family, word));
        let counted = problem.code == "no-quantity" && !self.lost.is_empty();
        self.whole && !counted && !words.any(|word| !word.is_empty() && lost(word))
    }

    /// The protocol that this one extends.
    pub fn parent(&self) -> Option<&Document> {
        self.ancestors.first().map(|parent| &parent.merged)
    }
}

/// Finds the text of a protocol by name or path, relative to the text that names it.
pub type Find<'a> = &'a dyn Fn(&str, &Source) -> Result<Arc<Source>, Problem>;

/// Reads a protocol, its ancestors and the texts whose rules they use.
pub fn read(source: &Arc<Source>, find: Find<'_>, problems: &mut Problems) -> Family {
    let mut reader = Reader {
        find,
        problems: &mut *problems,
        sources: Vec::new(),
        names: Vec::new(),
        whole: true,
    };
    let mut chain = vec![reader.text(source, None)];
    while let Some(field) = chain.last().and_then(|text| head_field(&text.document, EXTENDS)) {
        let field = field.clone();
        match reader.parent(&field, &chain) {
            Some(found) => chain.push(reader.text(&found, Some(&field))),
            None => {
                reader.whole = false;
                break;
            }
        }
    }
    let Reader { sources, names, whole, .. } = reader;
    let mut lost = Vec::new();
    let mut merged: Option<Document> = None;
    let mut ancestors: Vec<Ancestor> = Vec::new();
    let mut known = Vec::new();
    while let Some(Written { document: written, used, from }) = chain.pop() {
        let mut base = merged.take();
        for text in used {
            let (text, missing) = families::expand(&text, base.as_ref(), &mut known, problems);
            lost.extend(missing);
            base = Some(with_used(base, text));
        }
        let left = base.map(|base| without_removed(&base, &written, &known, problems));
        let (document, missing) = families::expand(&written, left.as_ref(), &mut known, problems);
        lost.extend(missing);
        let together = left.map_or_else(|| document.clone(), |left| merge(left, &document));
        if !chain.is_empty() {
            let mut merged = together.clone();
            // What is wrong in it is told of the whole.
            like::write_out(&mut merged, false, &mut Problems::default());
            ancestors.insert(0, Ancestor { merged, from });
        }
        merged = Some(together);
    }
    let mut merged = merged.unwrap_or_else(|| Document::empty(source));
    like::write_out(&mut merged, whole && lost.is_empty(), problems);
    Family { merged, ancestors, sources, names, whole, lost }
}

/// A text, and those whose rules it uses.
struct Written {
    document: Document,
    used: Vec<Document>,
    /// Where its texts begin.
    from: usize,
}

/// Reads the texts of a protocol, in the order of [`Family::sources`].
struct Reader<'a> {
    find: Find<'a>,
    problems: &'a mut Problems,
    sources: Vec<Arc<Source>>,
    names: Vec<Option<Text>>,
    whole: bool,
}

impl Reader<'_> {
    fn text(&mut self, source: &Arc<Source>, named_by: Option<&Field>) -> Written {
        let (from, document) = (self.sources.len(), self.read(source, named_by));
        let mut used = Vec::new();
        for field in head(&document).into_iter().flat_map(|head| head.fields_named(USES)) {
            match self.used(field, source) {
                Some(text) => used.push(text),
                None => self.whole = false,
            }
        }
        Written { document, used, from }
    }

    fn read(&mut self, source: &Arc<Source>, named_by: Option<&Field>) -> Document {
        let mut own = Problems::default();
        let document = syntax::read(source, &mut own);
        match named_by
            .filter(|_| document.blocks.iter().all(|block| keys::of_block(block).is_none()))
        {
            // The file may be of any kind; its lines are then not printed.
            Some(field) => {
                let says = format!("`{}` is not a protocol", named(field));
                self.problems.push(error("not-a-protocol", says, field));
                self.whole = false;
            }
            None => self.problems.add(own.0),
        }
        self.sources.push(Arc::clone(source));
        self.names.push(head(&document).and_then(|head| head.name.clone()));
        document
    }

    fn named(&mut self, field: &Field, from: &Source) -> Option<Arc<Source>> {
        (self.find)(named(field), from)
            .map_err(|problem| self.problems.push(problem.at(field)))
            .ok()
    }

    /// A text that another uses. It has no quantities, and no text behind it.
    fn used(&mut self, field: &Field, from: &Source) -> Option<Document> {
        let source = self.named(field, from)?;
        let text = self.read(&source, Some(field));
        let name = named(field);
        let quantity = text.blocks.iter().find(|block| block.kind.text == "quantity");
        let behind = [EXTENDS, USES].iter().find_map(|key| head_field(&text, key));
        let problem = match (quantity, behind) {
            (None, None) => return Some(text),
            (Some(quantity), _) => {
                let says = format!("`{name}` is a protocol with quantities and cannot be used");
                error("uses-protocol", says, field)
                    .also(quantity, "the first quantity")
                    .help(format!("write `extends {name}`"))
            }
            (None, Some(behind)) => {
                let says = format!("`{name}` cannot be used: it needs another text itself");
                error("uses-protocol", says, field)
                    .also(behind, "here")
                    .help("name both texts in the protocol, each with `uses`")
            }
        };
        self.problems.push(problem);
        None
    }

    /// The text that the last of a chain extends.
    fn parent(&mut self, field: &Field, chain: &[Written]) -> Option<Arc<Source>> {
        if chain.len() > DEEPEST {
            self.problems.push(problem!(
                "extends-too-deep",
                field,
                "more than {DEEPEST} protocols extend each other"
            ));
            return None;
        }
        let found = self.named(field, &chain.last()?.document.source)?;
        if chain.iter().any(|known| known.document.source.name == found.name) {
            let says = if chain.len() == 1 {
                "this protocol extends itself".into()
            } else {
                format!("`{}` extends this protocol again", named(field))
            };
            self.problems.push(error("extends-loop", says, field));
            return None;
        }
        Some(found)
    }
}

/// Whether a member of a family can have this name: `Y_phase` of `Y_{part}`.
fn may_be_of(family: &str, name: &str) -> bool {
    let (start, end) = (family.find('{'), family.rfind('}'));
    match (start, end) {
        (Some(start), Some(end)) => {
            name.starts_with(&family[..start]) && name.ends_with(&family[end + 1..])
        }
        _ => family == name,
    }
}

fn head(document: &Document) -> Option<&Block> {
    document.blocks.iter().find(|block| block.kind.text == "protocol")
}

fn head_field<'a>(document: &'a Document, key: &str) -> Option<&'a Field> {
    head(document)?.field(key)
}

/// The name or path in `extends` or `uses`.
fn named(field: &Field) -> &str {
    field.value.text.trim().trim_matches('"')
}

/// The rules with those of a text that is used behind them. What is there already stays as it is.
fn with_used(base: Option<Document>, text: Document) -> Document {
    let mut base = base.unwrap_or_else(|| Document::empty(&text.source));
    for block in text.blocks.into_iter().filter(|block| block.kind.text != "protocol") {
        if !base.blocks.iter().any(|known| is_same(known, &block)) {
            base.blocks.push(block);
        }
    }
    base
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
        match blocks.iter_mut().find(|other| is_same(other, block)) {
            None => blocks.push(block.clone()),
            Some(old) if block.kind.text == "protocol" => *old = succeed(old, block),
            Some(old) => overlay(old, block),
        }
    }
    Document { blocks, ..Document::empty(&variant.source) }
}

/// Whether two blocks are of one kind and name.
fn is_same(one: &Block, other: &Block) -> bool {
    let single = |block| keys::of_block(block).is_some_and(|kind| kind.single);
    one.kind.text == other.kind.text
        && single(one) == single(other)
        && (single(one) || one.name_text() == other.name_text())
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
