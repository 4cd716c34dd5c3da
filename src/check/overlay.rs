//! The fields of a variant over those of its parent.

use super::prelude::*;
use crate::syntax::phrase::{Limit, Scope};

/// Puts fields of the variant in place of fields of the parent with the same slot; other fields
/// stay.
pub fn overlay(parent: &mut Block, variant: &Block) {
    // A block without a name is pointed at by its kind.
    parent.kind.clone_from(&variant.kind);
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
        // What is absent has its default, or no value.
        "default" => says("optional") || says("is"),
        "optional" => says("default") || says("is"),
        // A datum is computed, or it is found or in a table.
        "found" | "column" => says("is"),
        "is" => says("found") || says("column"),
        "in" => says("one of"),
        "one of" => says("in"),
        // A rule and the judgement of a person replace each other, too.
        "of" => says("judged by"),
        "holds" | "validated" => says("judged by") || says("outcome"),
        "judged by" => says("holds") || says("outcome"),
        "words" => says("outcome"),
        "outcome" => says("holds") || says("validated") || says("judged by") || says("words"),
        // And a limit and the reason why there is none.
        "reported" => says("limit"),
        "limit" => says("reported"),
        // A number of one's own with its source is not the one that was to be confirmed.
        "unconfirmed" => {
            let own = says("default") || says("is") || parent.kind.text == "zone" && says("where");
            own && (says("source") || says("clause"))
        }
        _ => false,
    };
    let slots: Vec<Slot> = variant.fields.iter().map(slot).collect();
    let mut left: Vec<Option<&Field>> = variant.fields.iter().map(Some).collect();
    let mut fields = Vec::new();
    for field in parent.fields.drain(..) {
        let own = slot(&field);
        // The first field of a slot is replaced by all of the variant's, so that the order of the
        // parent is kept.
        for (_, new) in slots.iter().zip(&mut left).filter(|(slot, _)| **slot == own) {
            fields.extend(new.take().cloned());
        }
        if !slots.contains(&own) && !replaced(&field) {
            fields.push(field);
        }
    }
    fields.extend(left.into_iter().flatten().cloned());
    parent.fields = fields;
}

/// What identifies a field when it is overridden.
#[derive(Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "there are few at a time")]
pub enum Slot {
    Key(String),
    /// A limit that was not understood, by its text.
    Unclear(String),
    Limit(SlotOfLimit),
    /// A minimum, by its groups.
    Minimum(Option<Scope>),
}

/// A limit, by its statistic, direction and scope.
#[derive(Debug)]
pub struct SlotOfLimit(Limit);

impl PartialEq for SlotOfLimit {
    fn eq(&self, other: &Self) -> bool {
        self.0.same_slot(&other.0)
    }
}

/// The slot of a field: its key; for a limit also its statistic and its scope, for a minimum of
/// which groups.
pub fn slot(field: &Field) -> Slot {
    let quiet = &mut Problems::default();
    match field.key.text.as_str() {
        "minimum pairs" => {
            Slot::Minimum(from_pest::minimum(&field.value, quiet).map(|of| of.scope))
        }
        "limit" => match from_pest::limit(&field.value, quiet) {
            Some(limit) => Slot::Limit(SlotOfLimit(limit)),
            None => Slot::Unclear(field.value.text.clone()),
        },
        key => Slot::Key(key.to_string()),
    }
}
