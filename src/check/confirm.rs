//! Values that a user answers for: those that the protocol marks as `unconfirmed`, and those set in
//! place of a default. Each is confirmed for one edition of the protocol and for one value.

use super::{Overrides, prelude::*};
use crate::result::{Confirmation, ConfirmedValue, Remark, StatedValue, Unmatched};

/// The values of a protocol that are to be confirmed, against the confirmations of a campaign.
pub fn values(blocks: &[Block], overrides: &Overrides) -> StatedValues {
    let head = blocks.iter().find(|block| block.kind.text == "protocol");
    let edition = head.and_then(|head| head.text("edition"));
    let mut values = StatedValues::default();
    let all: Vec<StatedValue> =
        blocks.iter().filter_map(|block| stated(block, overrides)).collect();
    for confirmation in &overrides.confirmed {
        let of = all.iter().find(|stated| stated.name == confirmation.name);
        let why = match of {
            Some(stated) => unmatched(confirmation, &edition, stated),
            None => Some(Unmatched::NothingToConfirm),
        };
        let (name, by) = (confirmation.name.clone(), confirmation.signed.by.clone());
        let told = why.map(|why| Remark::ConfirmationNotCounted { name, by, why });
        values.not_counted.extend(told);
    }
    for value in all {
        let counts = |confirmation: &&Confirmation| {
            confirmation.name == value.name && unmatched(confirmation, &edition, &value).is_none()
        };
        match overrides.confirmed.iter().find(counts) {
            Some(Confirmation { signed, .. }) => {
                values.confirmed.push(ConfirmedValue { value, signed: signed.clone() });
            }
            None => values.provisional.push(value),
        }
    }
    values
}

/// The value of a block, if it is to be confirmed.
fn stated(block: &Block, overrides: &Overrides) -> Option<StatedValue> {
    let kind = block.kind.text.as_str();
    let (own_name, unconfirmed) = (block.own_name(), block.text("unconfirmed"));
    let default = block.field("default").map(|field| normalised(&field.value.text));
    let set = overrides.get(&own_name).filter(|_| kind == "parameter");
    let set = set.map(|set| normalised(&set.text.text));
    let own = set.filter(|set| default.as_ref().is_none_or(|default| !same(set, default)));
    let fields = |keys: &[&str]| {
        let fields = block.fields.iter().filter(|field| keys.contains(&field.key.text.as_str()));
        let texts = fields.map(|field| normalised(&field.value.text));
        texts.collect::<Vec<_>>().join("; ")
    };
    let name = if kind == "zone" { format!("zone {own_name}") } else { own_name };
    let (text, why) = match (kind, own, unconfirmed) {
        ("parameter", Some(own), _) => (own, None),
        ("parameter", None, Some(why)) => (default?, Some(why)),
        ("define" | "estimate", _, Some(why)) => (fields(&["is"]), Some(why)),
        ("quantity", _, Some(why)) => (fields(&["limit", "report"]), Some(why)),
        ("zone", _, Some(why)) => (fields(&["where", "minimum length"]), Some(why)),
        _ => return None,
    };
    let (value, unit) = parts(&text);
    let clause = block.text("clause").or_else(|| block.text("source"));
    Some(StatedValue {
        name,
        title: block.title_text().unwrap_or_default(),
        value,
        unit,
        clause,
        why,
    })
}

/// `4 kN` in its number and unit; any other text is a value as it is.
fn parts(text: &str) -> (String, Option<String>) {
    match text.split_once(' ') {
        Some((number, unit)) if number.parse::<f64>().is_ok() && Unit::parse(unit).is_ok() => {
            (number.to_owned(), Some(unit.to_owned()))
        }
        _ => (text.to_owned(), None),
    }
}

/// Why a confirmation is not one of a value.
fn unmatched(
    confirmation: &Confirmation,
    edition: &Option<String>,
    stated: &StatedValue,
) -> Option<Unmatched> {
    let words = |text: &Option<String>| text.as_deref().map(normalised).unwrap_or_default();
    if words(&confirmation.edition) != words(edition) {
        return Some(Unmatched::OtherEdition { edition: edition.clone().unwrap_or_default() });
    }
    let value = stated.in_words();
    (!same(&confirmation.in_words(), &value)).then_some(Unmatched::OtherValue { value })
}

/// Whether two texts are the same value: `4 kN` and `4000 N` are.
fn same(one: &str, other: &str) -> bool {
    let number = |text: &str| {
        let (number, unit) = parts(&normalised(text));
        let unit = Unit::parse(unit.as_deref().unwrap_or("-")).ok()?;
        Some((unit.to_si(number.parse().ok()?), unit.dimension))
    };
    match (number(one), number(other)) {
        (Some((a, of_a)), Some((b, of_b))) => {
            of_a == of_b && (a - b).abs() <= ROUNDING * a.abs().max(b.abs())
        }
        _ => normalised(one) == normalised(other),
    }
}

/// Relative difference of two equal values in different units: the rounding of their conversion.
const ROUNDING: f64 = 1e-12;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_value_may_be_written_in_another_unit() {
        assert!(same("4 kN", "4000 N") && same("20 Hz", "20.0 Hz") && same("0.8", "80 %"));
        assert!(!same("4 kN", "4 kN*m") && !same("4 kN", "4"));
        assert!(same("radius  < 600 m", "radius < 600 m") && !same("radius < 600 m", "radius"));
    }
}
