//! The fields of a variant over those of its parent.

use indexmap::IndexMap;

use crate::problem::Problems;
use crate::syntax::document::{Block, Field};
use crate::syntax::from_pest;

/// Puts fields of the variant in place of fields of the parent with the same slot; other fields
/// stay.
pub fn overlay(parent: &mut Block, variant: &Block) {
    parent.name.clone_from(&variant.name);
    if variant.title.is_some() {
        parent.title.clone_from(&variant.title);
    }
    let says = |key: &str| variant.field(key).is_some();
    let replaced = |field: &Field| match field.key.text.as_str() {
        // A metric replaces value and difference, a unit replaces a choice of words, and the other
        // way round.
        "value" => says("metric"),
        "difference" => says("metric") || says("from"),
        "metric" => says("value") || says("difference") || says("from"),
        // The values of one record are not compared.
        "compare" => says("from"),
        "from" => says("difference") || says("metric") || says("compare"),
        "in" => says("one of"),
        "one of" => says("in"),
        // A rule and the judgement of a person replace each other, too.
        "holds" | "of" => says("judged by"),
        "judged by" => says("holds"),
        // And a limit and the reason why there is none.
        "reported" => says("limit"),
        "limit" => says("reported"),
        // A number of one's own is not the one that was to be confirmed.
        "unconfirmed" => {
            says("default") || says("is") || parent.kind.text == "zone" && says("where")
        }
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
        // The first field of a slot is replaced by all of the variant's, so that the order of the
        // parent is kept.
        fields.extend(new.shift_remove(&slot).unwrap_or_default());
        if !taken.contains(&slot) && !replaced(&field) {
            fields.push(field);
        }
    }
    fields.extend(new.into_values().flatten());
    parent.fields = fields;
}

/// What identifies a field when it is overridden: its key; for a limit also its statistic and its
/// scope, for a minimum of which groups.
pub fn slot(field: &Field) -> String {
    if field.key.text == "minimum pairs" {
        return format!("minimum pairs {}", super::minima::groups_of(field).unwrap_or_default());
    }
    if field.key.text != "limit" {
        return field.key.text.clone();
    }
    match from_pest::limit(&field.value, &mut Problems::default()) {
        Some(limit) => format!("limit {} {}", limit.bounds(), limit.scope.node.meaning()),
        None => format!("limit {}", field.value.text),
    }
}
