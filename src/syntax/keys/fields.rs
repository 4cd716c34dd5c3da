//! Fields: how they are put into the table, and those that many blocks have.

use super::{EACH, Key, OPTIONAL as OPTIONAL_WORD, Sort};

pub(super) const fn text(word: &'static str, about: &'static str, example: &'static str) -> Key {
    Key { word, sort: Sort::Text, many: false, list: false, pattern: false, about, example }
}

pub(super) const fn phrase(word: &'static str, about: &'static str, example: &'static str) -> Key {
    Key { word, sort: Sort::Phrase, many: false, list: false, pattern: false, about, example }
}

pub(super) const fn many(key: Key) -> Key {
    Key { many: true, ..key }
}

pub(super) const fn list(key: Key) -> Key {
    Key { list: true, ..key }
}

pub(super) const fn pattern(key: Key) -> Key {
    Key { pattern: true, ..key }
}

pub(super) const FOR_EACH: Key = many(phrase(
    EACH,
    "Makes the block a family: one block for each member, which replaces `{variable}`.",
    "channel in Y, Q and part in magnitude, phase",
));
pub(super) const OPTIONAL: Key = phrase(
    OPTIONAL_WORD,
    "It may be absent. What needs it is then `not assessed`, and the rest is, or `not assessable`, and with it the verdict.",
    "not assessed",
);
pub(super) const CLAUSE: Key =
    text("clause", "Clause of the standard for the rule.", "Annex T, T.3");
pub(super) const PARAPHRASE: Key = text(
    "paraphrase",
    "What the clause asks for, in own words; without it, the title of the block says so.",
    "The largest values of simulation and measurement agree.",
);
pub(super) const SOURCE: Key =
    text("source", "Publication of the rule or number.", "Goetz & Polach, Table 1");
pub(super) const UNCONFIRMED: Key = text(
    "unconfirmed",
    "Why its number is not from a checked source. Until the campaign confirms it, the report prints \"to be confirmed\" beside it, \"against the standard\" if the protocol has a `source`, and the verdict is provisional.",
    "Read in a secondary source; the standard was not to hand.",
);
pub(super) const WORDS: Key = list(phrase(
    "words",
    "The two words of the verdict: the word if it holds, and the word if it does not.",
    "accepted, not accepted",
));
pub(super) const NOTE: Key = many(text(
    "note",
    "A remark printed with the rule.",
    "Absolute values of simulation and measurement.",
));
