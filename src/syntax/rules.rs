//! Rules for blocks and fields in both forms: known, named, not empty, given once.

use std::collections::BTreeMap;

use super::{
    document::{Block, Field, Text},
    keys::{KINDS, Key, Kind, NOT_ASSESSABLE, NOT_STATED, OPTIONAL},
    lines,
    phrase::normalised,
};
use crate::problem::{Problem, Problems, error, nearest, problem, warning};
use crate::source::Span;

/// Largest number of words of a key.
const LONGEST: usize = 3;

/// The form a document is read from; it decides the spelling in messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    Lines,
    Yaml,
}

impl Form {
    fn spelling(self, kind: &Kind) -> &'static str {
        match self {
            Self::Lines => kind.word,
            Self::Yaml => kind.group,
        }
    }
}

/// The kind of a word, of the other form's word for it, or of a similar word.
pub fn meant_kind(form: Form, word: &str) -> Option<&'static Kind> {
    let named = |name: &str| KINDS.iter().find(|kind| form.spelling(kind) == name);
    named(word)
        .or_else(|| KINDS.iter().find(|kind| kind.word == word || kind.group == word))
        .or_else(|| near(word, KINDS.iter().map(|kind| form.spelling(kind))).and_then(named))
}

/// Collects blocks as they are read and reports problems.
#[derive(Debug)]
pub struct Reader<'a> {
    pub problems: &'a mut Problems,
    form: Form,
    blocks: Vec<Block>,
    /// The first place of each kind and name.
    seen: BTreeMap<(&'static str, String), Span>,
}

impl<'a> Reader<'a> {
    pub fn new(form: Form, problems: &'a mut Problems) -> Self {
        Self { problems, form, blocks: Vec::new(), seen: BTreeMap::new() }
    }

    pub fn finish(self) -> Vec<Block> {
        self.blocks
    }

    /// The kind of block of a word, or the most similar one after a problem.
    pub fn kind(&mut self, word: &str, at: &Span) -> Option<&'static Kind> {
        let form = self.form;
        let spelt = |kind: &Kind| form.spelling(kind);
        let near = meant_kind(form, word);
        if let Some(kind) = near.filter(|kind| spelt(kind) == word) {
            return Some(kind);
        }
        let owners = owners(word);
        let help = match near {
            Some(near) => format!("did you mean `{}`?", spelt(near)),
            None if owners.is_empty() => {
                let mut known: Vec<&str> = KINDS.iter().map(spelt).collect();
                known.dedup();
                format!("known here: {}", known.join(", "))
            }
            None => {
                let owners = listed(&owners);
                let below = match form {
                    Form::Lines => "their block",
                    Form::Yaml => "the name of their block",
                };
                format!("`{word}` is a field of {owners}; fields are indented below {below}")
            }
        };
        self.problems.push(
            problem!("unknown-block", at, "`{word}` is not a block of a protocol").help(help),
        );
        near
    }

    /// Reports words that begin no field of the kind. Returns the field that is most likely meant,
    /// with its number of words.
    pub fn unknown_field(
        &mut self,
        kind: &'static Kind,
        words: &[&str],
        at: &Span,
    ) -> Option<(&'static Key, usize)> {
        let other = beginnings(words)
            .map(|(word, count)| (owners(&word), count))
            .find(|(owners, _)| !owners.is_empty());
        // `minimum signal` is a misspelling of `minimum signals` rather than the `minimum` of
        // another kind.
        let near = near_key(kind, words)
            .filter(|(_, count)| other.as_ref().is_none_or(|(_, other)| count > other));
        // In YAML, a key is compared as a whole.
        let near = near.filter(|(_, count)| self.form == Form::Lines || *count == words.len());
        // `minimum total length` in a zone, which has `minimum length`, is not the `minimum` of
        // `sections`.
        let begins = |key: &Key| {
            words.len() > 1
                && key.word.split(' ').count() > 1
                && key.word.split(' ').next() == words.first().copied()
        };
        let other = other
            .filter(|(_, count)| *count > 1 || !kind.keys.iter().any(begins))
            .map(|(owners, _)| owners)
            .unwrap_or_default();
        let count = near.map_or(1, |(_, count)| count);
        // A field of the block with the same word that has a name, or has none.
        let twin = kind.with_name(!kind.named);
        let of_twin =
            beginnings(words).find(|(word, _)| twin.key(word).is_some()).map(|(_, count)| count);
        let count = of_twin.unwrap_or(count);
        let written = if self.form == Form::Yaml {
            words.join(" ")
        } else {
            words[..count.min(words.len())].join(" ")
        };
        let (word, group) = (kind.word, twin.group);
        let of = match (of_twin, kind.named) {
            (None, _) => "",
            (Some(_), true) => " with a name",
            (Some(_), false) => " without a name",
        };
        let help = if of_twin.is_some() {
            match (kind.named, self.form) {
                (true, Form::Lines) => format!("it is a field of the `{word}` without a name"),
                (true, Form::Yaml) => format!("it is a field of `{group}`"),
                (false, Form::Lines) => {
                    format!("it is a field of a `{word}` with a name: `{word} some_name`")
                }
                (false, Form::Yaml) => format!("it is a field of `{group}`, below a name"),
            }
        } else if written == "title" {
            "write the title in quotes on the first line of its block".into()
        } else if let ("remove", ["every", of, ..]) = (word, words)
            && kind.key(of).is_some()
        {
            format!("write `{of} every`")
        } else if let Some((near, _)) = near {
            format!("did you mean `{}`?", near.word)
        } else if !other.is_empty() {
            format!("it is a field of {}", listed(&other))
        } else {
            let known: Vec<&str> = kind.keys.iter().map(|key| key.word).collect();
            format!("known here: {}", known.join(", "))
        };
        self.problems.push(
            problem!("unknown-field", at, "a `{word}`{of} has no field `{written}`").help(help),
        );
        near.filter(|_| of_twin.is_none())
    }

    /// How a field is written that stands in the line of a block without a name: `remove
    /// plausibility drift`.
    pub fn field_beside(&self, kind: &'static Kind, words: &str) -> Option<String> {
        if kind.with_name(true).named {
            return None;
        }
        let words: Vec<&str> = words.split_whitespace().collect();
        let line = match words[..] {
            ["every", field, ..] if kind.key(field).is_some() => format!("{field} every"),
            _ if key(kind, &words).is_some() => words.join(" "),
            _ => return None,
        };
        Some(format!("write it on a line of its own, indented: `{line}`"))
    }

    /// Adds a field to its block unless it is empty or already there.
    pub fn field(
        &mut self,
        kind: &'static Kind,
        key: &'static Key,
        block: &mut Block,
        field: Field,
    ) {
        if field.value.text.trim().is_empty() {
            let example = match (key.sort, self.form) {
                (super::keys::Sort::Text, Form::Lines) => quoted(key.example),
                _ => key.example.to_owned(),
            };
            let colon = if self.form == Form::Yaml { ":" } else { "" };
            let help = format!("for example: {}{colon} {example}", key.word);
            self.problems.push(
                problem!("missing-value", &field.key, "`{}` has no value", key.word).help(help),
            );
            return;
        }
        let (key, field) = self.in_present_words(kind, key, field);
        if let Some(first) = block.field(key.word).filter(|_| !key.many) {
            self.problems.push(
                problem!(
                    "duplicate-field",
                    &field.key,
                    "a `{}` can have only one `{}`",
                    kind.word,
                    key.word
                )
                .also(&first.key, "the first"),
            );
            return;
        }
        block.fields.push(field);
    }

    /// `default not stated`, as the first versions had it, in the present words: it is read as
    /// before, and `fmt` writes what it is now.
    fn in_present_words(
        &mut self,
        kind: &'static Kind,
        key: &'static Key,
        mut field: Field,
    ) -> (&'static Key, Field) {
        let optional = kind.key(OPTIONAL).filter(|_| key.word == "default");
        let Some(now) = optional.filter(|_| normalised(&field.value.text) == NOT_STATED) else {
            return (key, field);
        };
        let colon = if self.form == Form::Yaml { ":" } else { "" };
        let says = format!("`default {NOT_STATED}` is an old spelling");
        let help = format!("write `{OPTIONAL}{colon} {NOT_ASSESSABLE}`, as `fishplate fmt` does");
        self.problems.push(warning("old-spelling", says, &field.value).help(help));
        for (text, word) in [(&mut field.key, now.word), (&mut field.value, NOT_ASSESSABLE)] {
            *text = Text { text: word.into(), exact: false, ..text.clone() };
        }
        (now, field)
    }

    /// Adds a block unless there is one with its kind and name.
    pub fn block(&mut self, kind: &'static Kind, block: Block) {
        let word = kind.word;
        let problem = match &block.name {
            None if kind.named => {
                let help = match self.form {
                    Form::Lines => format!("write a name after the word: {word} some_name"),
                    Form::Yaml if kind.single => "add an entry `name`".to_owned(),
                    Form::Yaml => "write its name as the key above its fields".to_owned(),
                };
                Some(problem!("missing-name", &block.kind, "this `{word}` has no name").help(help))
            }
            Some(name) if !kind.named => {
                let help = format!("there is one `{word}` block in a protocol");
                Some(problem!("unexpected-name", name, "a `{word}` block has no name").help(help))
            }
            Some(name) if kind.has_families() && lines::is_family_name(&name.text) => None,
            Some(name) if !lines::is_name(&name.text) => {
                let family = lines::is_family_name(&name.text).then(|| {
                    format!("a `{word}` cannot be a family: write its name without braces")
                });
                Some(bad_name(name).help_if(family))
            }
            _ => None,
        };
        self.problems.add(problem);
        if let Some(title) = block.title.as_ref().filter(|title| title.text.trim().is_empty()) {
            self.problems.push(error("missing-value", "the title is empty", title));
        }
        // A block without its required name is not compared with others.
        if !kind.named || kind.single || block.name.is_some() {
            let name = if kind.single { String::new() } else { block.own_name() };
            if let Some(first) = self.seen.get(&(kind.word, name.clone())) {
                let (code, says) = if kind.single {
                    ("duplicate-block", format!("a protocol can have only one `{word}` block"))
                } else {
                    ("duplicate-name", format!("there are two blocks `{word} {name}`"))
                };
                self.problems.push(error(code, says, &block).also(first, "the first"));
                return;
            }
            self.seen.insert((kind.word, name), block.span().clone());
        }
        self.blocks.push(block);
    }
}

pub fn unterminated(at: &Span) -> Problem {
    error("unterminated-quote", "a quote is not closed on its line", at)
        .help("write a quote inside a text as \\\"")
}

pub fn bad_name(written: &Text) -> Problem {
    let name = &written.text;
    let made_of = if name.contains('{') {
        "in the name of a family, write a variable in braces without blanks: `Y_{part}`"
    } else {
        "use letters a to z, digits, `_`, `-` and `.`"
    };
    let help = lines::slip(name).unwrap_or_else(|| made_of.to_owned());
    problem!("bad-name", written, "`{name}` cannot be a name").help(help)
}

/// The longest key that the first words form, and its number of words.
pub fn key(kind: &'static Kind, words: &[&str]) -> Option<(&'static Key, usize)> {
    beginnings(words).find_map(|(word, count)| kind.key(&word).map(|key| (key, count)))
}

fn near_key(kind: &'static Kind, words: &[&str]) -> Option<(&'static Key, usize)> {
    beginnings(words).find_map(|(word, count)| {
        let like = |known: &&str| known.split(' ').count() == count;
        let near = near(&word, kind.keys.iter().map(|key| key.word).filter(like))?;
        kind.key(near).map(|key| (key, count))
    })
}

/// The first words joined by blanks, and how many they are; the longest beginning first.
fn beginnings(words: &[&str]) -> impl Iterator<Item = (String, usize)> {
    (1..=words.len().min(LONGEST)).rev().map(|count| (words[..count].join(" "), count))
}

/// The most similar candidate, if at most a third of the letters differ.
fn near<'a>(word: &str, candidates: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    nearest(word, candidates).filter(|near| {
        3 * strsim::damerau_levenshtein(word, near)
            <= word.chars().count().max(near.chars().count())
    })
}

/// The kinds that have a field with these words.
fn owners(word: &str) -> Vec<&'static str> {
    let mut owners: Vec<&str> =
        KINDS.iter().filter(|kind| kind.key(word).is_some()).map(|kind| kind.word).collect();
    owners.dedup();
    owners
}

/// `a`, `b` and `c`
fn listed(words: &[&str]) -> String {
    match words {
        [] => String::new(),
        [one] => format!("`{one}`"),
        [first @ .., last] => format!("`{}` and `{last}`", first.join("`, `")),
    }
}

/// Sorts the problems from the given index on by their places.
pub fn in_reading_order(problems: &mut Problems, from: usize) {
    if let Some(new) = problems.0.get_mut(from..) {
        new.sort_by_key(|problem| problem.at.as_ref().map_or(0, |at| at.start));
    }
}

/// Prose in quotes, as in the text form.
pub fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n"))
}

/// A text that is exactly the text of its place.
pub fn exact(span: Span) -> Text {
    Text { text: span.text().to_owned(), span, exact: true }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_is_longer_than_is_looked_for() {
        assert!(
            KINDS
                .iter()
                .flat_map(|kind| kind.keys)
                .all(|key| key.word.split(' ').count() <= LONGEST)
        );
    }

    #[test]
    fn the_longest_key_wins() {
        let zone = super::super::keys::kind("zone").expect("a kind");
        assert_eq!(
            key(zone, &["minimum", "sections", "of"]).map(|(key, count)| (key.word, count)),
            Some(("minimum sections", 2))
        );
        assert_eq!(
            near_key(zone, &["minimun", "length"]).map(|(key, count)| (key.word, count)),
            Some(("minimum length", 2))
        );
    }
}
