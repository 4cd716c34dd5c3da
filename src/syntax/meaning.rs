//! Whether two values of a field mean the same, however they are written.

use super::{
    document::Text,
    from_pest,
    keys::{self, Sort},
    phrase::Pick,
};
use crate::problem::Problems;
use crate::units::{Dimension, Unit};

/// Whether both fields can be read, and mean the same however they are written.
fn alike<T: PartialEq>(a: &Text, b: &Text, read: fn(&Text, &mut Problems) -> Option<T>) -> bool {
    // Variables of families count as parts of names.
    let read = |text: &Text| {
        let text = Text { text: text.text.replace(['{', '}'], "_"), ..text.clone() };
        read(&text, &mut Problems::default())
    };
    read(a).is_some_and(|meant| read(b).is_some_and(|other| meant == other))
}

/// Whether two values of a field mean the same; not so for prose and for text that cannot be parsed.
pub fn same_meaning(kind: &str, key: &str, a: &Text, b: &Text) -> bool {
    let key = keys::kind(kind).and_then(|kind| {
        [true, false].into_iter().find_map(|named| kind.with_name(named).key(key))
    });
    let Some(key) = key.filter(|key| key.sort == Sort::Phrase) else { return false };
    match key.word {
        "over" => alike(a, b, from_pest::domain),
        "limit" if kind == "quantity" => alike(a, b, from_pest::limit),
        "report" => alike(a, b, from_pest::report),
        "minimum pairs" => alike(a, b, from_pest::minimum),
        "metric" => alike(a, b, from_pest::chain) || alike(a, b, from_pest::expression),
        "filter" | "step" => alike(a, b, from_pest::chain),
        "of" if matches!(kind, "verdict" | "define") => alike(a, b, from_pest::list),
        "outcome" if kind == "verdict" => alike(a, b, from_pest::outcome_of_verdict),
        "outcome" => alike(a, b, from_pest::outcome),
        "one of" | "members" => alike(a, b, from_pest::list),
        "validated" | "holds" => alike(a, b, from_pest::verdict),
        "of" => alike(a, b, |text, problems| {
            let of = from_pest::of_places(text, problems)?;
            Some((of.signal, picks(&of.picks), of.when))
        }),
        "at" => alike(a, b, |text, problems| Some(picks(&from_pest::places(text, problems)?))),
        "in" => alike(a, b, |text, _| unit(&text.text)),
        "axis" | "time" => alike(a, b, |text, problems| {
            let (name, written) = from_pest::axis(text, problems)?;
            Some((name, unit(&written.node)?))
        }),
        "range" => alike(a, b, from_pest::range),
        "alias" => alike(a, b, from_pest::alias),
        _ => alike(a, b, from_pest::expression),
    }
}

fn unit(text: &str) -> Option<(f64, Dimension)> {
    Unit::parse(text).ok().map(|unit| (unit.factor, unit.dimension))
}

/// Whether a word before a place stands for all of its positions.
pub fn is_each(word: &str) -> bool {
    matches!(word, "each" | "every" | "all")
}

/// Positions such as `at wheelsets 1, 3 and side L`; singular and plural have the same meaning.
fn picks(picks: &[Pick]) -> String {
    let one = |pick: &Pick| {
        let words = pick.words.iter().chain(&pick.more).map(|word| word.node.as_str());
        words
            .filter(|word| !is_each(word))
            .map(|word| word.strip_suffix('s').unwrap_or(word))
            .collect::<Vec<_>>()
            .join(" ")
    };
    picks.iter().map(one).collect::<Vec<_>>().join("; ")
}
