//! Differences in meaning between two protocols, rule by rule.

use std::cmp::Ordering;

use super::{find::AT_MOST, overlay::slot, prelude::*};
use crate::result::Deviation;
use crate::syntax::{
    keys::{self, NOT_ASSESSABLE, OPTIONAL},
    same_meaning,
};

/// Rules added, removed or changed from the first document to the second, in the order of the
/// second.
pub fn diff(before: &Document, after: &Document) -> Vec<Deviation> {
    changes(before, after).into_iter().map(|change| change.deviation).collect()
}

/// The same, each as a change that can be made to the first document by itself.
pub fn changes(before: &Document, after: &Document) -> Vec<Change> {
    let mut found = Vec::new();
    for (at, block) in after.blocks.iter().enumerate() {
        match before.blocks.iter().find(|old| same(old, block)) {
            None => {
                let after = after.blocks[..at].to_vec();
                let edit = Edit::Add { block: Box::new(block.clone()), after };
                found.push(Change::new(head(block), None, Some(in_words(block)), edit));
            }
            Some(old) => fields(old, block, &mut found),
        }
    }
    for block in &before.blocks {
        if !after.blocks.iter().any(|new| same(block, new)) {
            let edit = Edit::Remove(Box::new(block.clone()));
            found.push(Change::new(head(block), Some(in_words(block)), None, edit));
        }
    }
    found
}

/// Number of blocks of the first document that the second has with the same meaning.
pub fn kept(before: &Document, after: &Document) -> usize {
    let unchanged = |old: &&Block| {
        after.blocks.iter().find(|new| same(old, new)).is_some_and(|new| {
            let mut found = Vec::new();
            fields(old, new, &mut found);
            found.is_empty()
        })
    };
    before.blocks.iter().filter(unchanged).count()
}

/// A difference of two documents and how it is made.
#[derive(Clone, Debug)]
pub struct Change {
    pub deviation: Deviation,
    edit: Edit,
}

#[derive(Clone, Debug)]
enum Edit {
    /// A block, behind the last of these that is there.
    Add {
        block: Box<Block>,
        after: Vec<Block>,
    },
    Remove(Box<Block>),
    Title {
        of: Box<Block>,
        title: Option<Text>,
    },
    /// A field of a block in place of another.
    Field {
        of: Box<Block>,
        old: Option<Box<Field>>,
        new: Option<Box<Field>>,
    },
}

impl Change {
    fn new(rule: String, before: Option<String>, after: Option<String>, edit: Edit) -> Self {
        Self { deviation: Deviation { rule, before, after }, edit }
    }

    /// The block that is added, removed or changed.
    pub fn block(&self) -> &Block {
        match &self.edit {
            Edit::Add { block, .. } | Edit::Remove(block) => block,
            Edit::Title { of, .. } | Edit::Field { of, .. } => of,
        }
    }

    /// A field before and after; `None` where a whole block or its title is changed.
    pub fn field(&self) -> Option<[Option<&Field>; 2]> {
        match &self.edit {
            Edit::Field { old, new, .. } => Some([old.as_deref(), new.as_deref()]),
            _ => None,
        }
    }

    /// Whether no verdict can depend on it.
    pub fn only_words(&self) -> bool {
        match &self.edit {
            Edit::Title { .. } => true,
            Edit::Field { old, new, .. } => {
                old.iter().chain(new).all(|field| PRINTED.contains(&&*field.key.text))
            }
            Edit::Add { .. } | Edit::Remove(_) => false,
        }
    }

    /// Whether the protocol asks for less with it: where this can be told from the two texts.
    pub fn relaxes(&self) -> bool {
        match &self.edit {
            Edit::Remove(block) => REQUIREMENTS.contains(&block.kind.text.as_str()),
            Edit::Field { old, new, .. } => relaxed(old.as_deref(), new.as_deref()) == Some(true),
            Edit::Add { .. } | Edit::Title { .. } => false,
        }
    }

    /// A document with this change alone.
    pub fn applied(&self, document: &Document) -> Document {
        let mut document = document.clone();
        let blocks = &mut document.blocks;
        match &self.edit {
            Edit::Add { block, after } => {
                let place = after
                    .iter()
                    .rev()
                    .find_map(|known| blocks.iter().position(|block| same(known, block)));
                blocks.insert(place.map_or(0, |place| place + 1), block.as_ref().clone());
            }
            Edit::Remove(gone) => blocks.retain(|block| !same(block, gone)),
            Edit::Title { of, title } => {
                blocks
                    .iter_mut()
                    .filter(|block| same(block, of))
                    .for_each(|block| block.title.clone_from(title));
            }
            Edit::Field { of, old, new } => {
                for block in blocks.iter_mut().filter(|block| same(block, of)) {
                    let alike = |field: &Field, old: &Field| {
                        field.key.text == old.key.text && field.value.text == old.value.text
                    };
                    let place = old
                        .as_ref()
                        .and_then(|old| block.fields.iter().position(|field| alike(field, old)));
                    match (place, new) {
                        (Some(place), Some(new)) => block.fields[place] = new.as_ref().clone(),
                        (Some(place), None) => drop(block.fields.remove(place)),
                        (None, Some(new)) => block.fields.push(new.as_ref().clone()),
                        (None, None) => {}
                    }
                }
            }
        }
        document
    }
}

/// Fields that are printed and decide nothing.
pub const PRINTED: [&str; 11] = [
    "edition",
    "author",
    "scope",
    "leaves out",
    "clause",
    "source",
    "note",
    "unconfirmed",
    "cause",
    "symbol",
    "report",
];

/// Blocks without which less is asked for.
const REQUIREMENTS: [&str; 6] = ["zone", "check", "plausibility", "find", "domain", "quantity"];
/// What is done with a fault, the mildest first.
const TREATMENTS: [&str; 4] = ["note", "not used", "not assessable", "stop"];

/// Whether a field asks for less than the old one; `None` where this cannot be told.
fn relaxed(old: Option<&Field>, new: Option<&Field>) -> Option<bool> {
    let key = new.or(old)?.key.text.as_str();
    let quiet = &mut Problems::default();
    let (Some(old), Some(new)) = (old, new) else {
        let demands = matches!(key, "limit" | "removed") || key.starts_with("minimum");
        return (new.is_none() && demands || new.is_some() && matches!(key, "unless" | OPTIONAL))
            .then_some(true);
    };
    let words = |field: &Field| normalised(&field.value.text);
    let (before, after) = (words(old), words(new));
    match key {
        "limit" => {
            let (old, new) =
                (from_pest::limit(&old.value, quiet)?, from_pest::limit(&new.value, quiet)?);
            let order = size(&old.bound, &new.bound)?;
            if let (Some(old), Some(new)) = (&old.lower, &new.lower) {
                let wider = size(old, new)? == Ordering::Less || order == Ordering::Greater;
                return Some(wider);
            }
            Some(order == if new.at_least { Ordering::Less } else { Ordering::Greater })
        }
        "otherwise" | "faulty" => {
            let rank = |text: &str| TREATMENTS.iter().position(|known| *known == text);
            Some(rank(&after)? < rank(&before)?)
        }
        OPTIONAL => Some(before == NOT_ASSESSABLE && after != NOT_ASSESSABLE),
        // Draws of the sections make it neither stricter nor weaker for certain.
        "validated" | "holds" if after.starts_with(EVERY_LIMIT) && after != EVERY_LIMIT => None,
        "validated" | "holds" => Some(before == EVERY_LIMIT && after != EVERY_LIMIT),
        "removed" | "minimum" | "minimum sections" | "minimum length" | "minimum signals"
        | "minimum pairs" => {
            let read = |text: &str, quiet: &mut Problems| {
                let text = text.trim_start_matches(AT_MOST).trim();
                let text = Text { text: text.into(), exact: false, ..new.value.clone() };
                from_pest::expression(&text, quiet)
            };
            let order = size(&read(&before, quiet)?, &read(&after, quiet)?)?;
            Some(order == if key == "removed" { Ordering::Greater } else { Ordering::Less })
        }
        _ => None,
    }
}

/// The rule of a verdict that asks for the most.
const EVERY_LIMIT: &str = "when every limit holds";

/// How the second of two positive bounds compares with the first: two numbers, or products and sums
/// of which one part differs.
fn size(old: &Phrase, new: &Phrase) -> Option<Ordering> {
    match (&old.node, &new.node) {
        (Node::Number(old), Node::Number(new)) if old.dimension() == new.dimension() => {
            new.value.partial_cmp(&old.value)
        }
        (Node::Binary(operator, a, b), Node::Binary(other, c, d)) if operator == other => {
            let rises = matches!(operator, Operator::Add | Operator::Multiply);
            let falls = matches!(operator, Operator::Subtract | Operator::Divide);
            match (a == c, b == d) {
                (false, true) if rises || falls => size(a, c),
                (true, false) if rises => size(b, d),
                (true, false) if falls => size(b, d).map(Ordering::reverse),
                _ => None,
            }
        }
        _ => None,
    }
}

fn same(a: &Block, b: &Block) -> bool {
    let single = |block: &Block| keys::of_block(block).is_some_and(|kind| kind.single);
    a.kind.text == b.kind.text && (a.name_text() == b.name_text() || single(a) && single(b))
}

fn head(block: &Block) -> String {
    format!("{} {}", block.kind.text, block.name_text()).trim().to_string()
}

fn in_words(block: &Block) -> String {
    block
        .fields
        .iter()
        .map(|field| format!("{} {}", field.key.text, normalised(&field.value.text)))
        .collect::<Vec<_>>()
        .join("; ")
}

fn fields(old: &Block, new: &Block, found: &mut Vec<Change>) {
    if old.kind.text == "protocol" {
        // Name, title and scope always differ and are not rules.
        for key in ["axis", "time", "edition"] {
            compare_field(old, key, old.field(key), new.field(key), found);
        }
        return;
    }
    let title = |block: &Block| block.title.as_ref().map(|title| normalised(&title.text));
    if title(old) != title(new) {
        let edit = Edit::Title { of: Box::new(new.clone()), title: new.title.clone() };
        found.push(Change::new(format!("{}, title", head(new)), title(old), title(new), edit));
    }
    for key in keys::of_block(new).map_or(&[][..], |kind| kind.keys) {
        let olds: Vec<&Field> = old.fields_named(key.word).collect();
        let news: Vec<&Field> = new.fields_named(key.word).collect();
        if key.many {
            many(new, &olds, &news, found);
        } else {
            compare_field(new, key.word, olds.first().copied(), news.first().copied(), found);
        }
    }
}

/// Compares fields that may occur several times. Equal ones are removed first. A limit is then
/// compared with the one of the same statistic and zones; other fields in their order.
fn many(block: &Block, olds: &[&Field], news: &[&Field], found: &mut Vec<Change>) {
    let kind = &block.kind.text;
    let mut left: Vec<&Field> = olds.to_vec();
    let mut changed: Vec<&Field> = Vec::new();
    for new in news {
        match left.iter().position(|old| equal(kind, old, new)) {
            Some(at) => drop(left.remove(at)),
            None => changed.push(new),
        }
    }
    for new in changed {
        let limit = matches!(new.key.text.as_str(), "limit" | "minimum pairs");
        let partner = left.iter().position(|old| slot(old) == slot(new)).or_else(|| {
            left.iter().position(|old| {
                !limit || new.key.text == "limit" && statistic(old) == statistic(new)
            })
        });
        compare_field(block, &rule(new), partner.map(|at| left.remove(at)), Some(new), found);
    }
    for old in left {
        compare_field(block, &rule(old), Some(old), None, found);
    }
}

/// The name of a rule in differences: `quantity Y_max, limit std`.
pub fn rule_of(block: &Block, field: &Field) -> String {
    format!("{}, {}", head(block), rule(field))
}

fn rule(field: &Field) -> String {
    format!("{} {}", field.key.text, statistic(field)).trim().to_string()
}

/// The statistic of a limit, as written.
fn statistic(field: &Field) -> String {
    if field.key.text != "limit" {
        return String::new();
    }
    let first = || field.value.text.split_whitespace().next().unwrap_or("").to_string();
    from_pest::limit(&field.value, &mut Problems::default())
        .map_or_else(first, |limit| limit.statistic.node)
}

fn compare_field(
    block: &Block,
    rule: &str,
    old: Option<&Field>,
    new: Option<&Field>,
    found: &mut Vec<Change>,
) {
    let differs = match (old, new) {
        (None, None) => false,
        (Some(old), Some(new)) => !equal(&block.kind.text, old, new),
        _ => true,
    };
    if differs {
        let words = |field: Option<&Field>| field.map(|field| normalised(&field.value.text));
        let edit = Edit::Field {
            of: Box::new(block.clone()),
            old: old.cloned().map(Box::new),
            new: new.cloned().map(Box::new),
        };
        let rule = format!("{}, {rule}", head(block));
        found.push(Change::new(rule, words(old), words(new), edit));
    }
}

fn equal(kind: &str, a: &Field, b: &Field) -> bool {
    let (key, a, b) = (&a.key.text, &a.value, &b.value);
    a == b || same_meaning(kind, key, a, b)
}
