//! What differs in meaning between two protocols, rule by rule.

use crate::problem::Problems;
use crate::result::Deviation;
use crate::syntax::document::{Block, Document, Field, Text};
use crate::syntax::from_pest;
use crate::syntax::keys::{self, Sort};

use super::names::normalised;

/// Fields that say who wrote a protocol, not what it rules.
const NOT_RULES: [&str; 2] = ["extends", "author"];

/// Rules that are new, gone or changed from the first document to the second, in the order of the second.
pub fn diff(before: &Document, after: &Document) -> Vec<Deviation> {
    let mut found = Vec::new();
    for block in &after.blocks {
        match before.blocks.iter().find(|old| same(old, block)) {
            None => found.push(Deviation { rule: head(block), before: None, after: Some(in_words(block)) }),
            Some(old) => fields(old, block, &mut found),
        }
    }
    for block in &before.blocks {
        if !after.blocks.iter().any(|new| same(block, new)) {
            found.push(Deviation { rule: head(block), before: Some(in_words(block)), after: None });
        }
    }
    found
}

fn same(a: &Block, b: &Block) -> bool {
    a.kind.text == b.kind.text && (a.name_text() == b.name_text() || a.kind.text == "protocol")
}

fn head(block: &Block) -> String {
    format!("{} {}", block.kind.text, block.name_text()).trim().to_string()
}

fn in_words(block: &Block) -> String {
    block.fields.iter().map(|field| format!("{} {}", field.key.text, normalised(&field.value.text))).collect::<Vec<_>>().join("; ")
}

fn fields(old: &Block, new: &Block, found: &mut Vec<Deviation>) {
    if old.kind.text == "protocol" {
        // Name, title and scope differ between any two protocols and rule nothing.
        for key in ["axis", "time", "edition"] {
            one(old, key, old.field(key), new.field(key), found);
        }
        return;
    }
    let title = |block: &Block| block.title.as_ref().map(|title| normalised(&title.text));
    if title(old) != title(new) {
        found.push(Deviation { rule: format!("{}, title", head(new)), before: title(old), after: title(new) });
    }
    let keys = keys::kind(&new.kind.text).map_or(&[][..], |kind| kind.keys);
    for key in keys.iter().filter(|key| !NOT_RULES.contains(&key.word)) {
        let olds: Vec<&Field> = old.fields_named(key.word).collect();
        let news: Vec<&Field> = new.fields_named(key.word).collect();
        if !key.many {
            one(old, key.word, olds.first().copied(), news.first().copied(), found);
            continue;
        }
        // A limit is compared with the one of the same statistic, others by position.
        let leading = |field: &Field| {
            if key.word == "limit" { field.value.text.split_whitespace().next().unwrap_or("").to_string() } else { String::new() }
        };
        let mut left: Vec<&Field> = olds.clone();
        for field in &news {
            let at = left
                .iter()
                .position(|other| leading(other) == leading(field) && (key.word == "limit" || equal(&old.kind.text, other, field)));
            let partner = at.or_else(|| (key.word != "limit" && !left.is_empty()).then_some(0)).map(|at| left.remove(at));
            let rule = format!("{} {}", key.word, leading(field));
            one(new, rule.trim(), partner, Some(field), found);
        }
        for field in left {
            let rule = format!("{} {}", key.word, leading(field));
            one(new, rule.trim(), Some(field), None, found);
        }
    }
}

fn one(block: &Block, rule: &str, old: Option<&Field>, new: Option<&Field>, found: &mut Vec<Deviation>) {
    let differs = match (old, new) {
        (None, None) => false,
        (Some(old), Some(new)) => !equal(&block.kind.text, old, new),
        _ => true,
    };
    if differs {
        let words = |field: Option<&Field>| field.map(|field| normalised(&field.value.text));
        found.push(Deviation { rule: format!("{}, {rule}", head(block)), before: words(old), after: words(new) });
    }
}

/// The same meaning: equal words, or expressions that read the same (`0.4 m/s^2` and `0.40 m/s²`).
fn equal(kind: &str, a: &Field, b: &Field) -> bool {
    if normalised(&a.value.text) == normalised(&b.value.text) {
        return true;
    }
    let sort = keys::kind(kind).and_then(|kind| kind.key(&a.key.text)).map(|key| key.sort);
    sort == Some(Sort::Phrase)
        && (both(&a.value, &b.value, from_pest::limit)
            || both(&a.value, &b.value, from_pest::expression)
            || both(&a.value, &b.value, from_pest::chain))
}

fn both<T: PartialEq>(a: &Text, b: &Text, read: fn(&Text, &mut Problems) -> Option<T>) -> bool {
    let (a, b) = (read(a, &mut Problems::default()), read(b, &mut Problems::default()));
    a.is_some() && a == b
}
