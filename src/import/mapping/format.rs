//! What a mapping says of the form of its files; the rest is detected.

use super::reader::Reader;
use crate::foreign::{DateOrder, Format, Options, Separator};
use crate::problem::Problem;
use crate::source::Spanned;
use crate::yaml::Node;

pub(super) const KEYS: [&str; 9] = [
    "form",
    "separator",
    "decimal",
    "encoding",
    "header lines",
    "line of names",
    "line of units",
    "comment",
    "dates",
];
/// Separators that are written as words.
const WORDS: [(&str, Separator); 5] = [
    ("comma", Separator::Mark(',')),
    ("semicolon", Separator::Mark(';')),
    ("tab", Separator::Mark('\t')),
    ("blanks", Separator::Blanks),
    ("bar", Separator::Mark('|')),
];

pub(super) fn read(reader: &mut Reader<'_>, node: &Node) -> Options {
    let mut options = Options::default();
    if !reader.keys(node, &KEYS, "`format`") {
        return options;
    }
    options.form = word(reader, node, "form", Format::from_word, &Format::ALL.map(Format::word));
    let separator = |text: &str| {
        let mut letters = text.chars();
        let single = letters
            .next()
            .filter(|letter| letters.next().is_none() && !letter.is_alphanumeric())
            .map(Separator::Mark);
        WORDS.iter().find(|(word, _)| *word == text).map(|(_, separator)| *separator).or(single)
    };
    options.separator = word(reader, node, "separator", separator, &WORDS.map(|(word, _)| word));
    let decimal = |text: &str| match text {
        "comma" | "," => Some(','),
        "point" | "." => Some('.'),
        _ => None,
    };
    options.decimal = word(reader, node, "decimal", decimal, &["comma", "point"]);
    options.encoding = reader.text(node, "encoding").map(|text| text.value);
    options.dates = word(reader, node, "dates", DateOrder::from_word, &["dmy", "mdy", "ymd"]);
    options.comment = reader.text(node, "comment").map(|text| text.value);
    options.header_lines = line(reader, node, "header lines");
    options.names_line = line(reader, node, "line of names");
    options.units_line = line(reader, node, "line of units");
    options
}

fn word<T>(
    reader: &mut Reader<'_>,
    node: &Node,
    key: &str,
    read: impl Fn(&str) -> Option<T>,
    known: &[&str],
) -> Option<T> {
    let Spanned { value, span } = reader.text(node, key)?;
    let found = read(&value);
    if found.is_none() {
        let problem = Problem::error("unknown-word", format!("`{key}` has no `{value}`")).at(&span);
        reader.problems.push(problem.suggest(&value, known.iter().copied()));
    }
    found
}

fn line(reader: &mut Reader<'_>, node: &Node, key: &str) -> Option<usize> {
    let found = reader.text(node, key)?;
    let number = found.value.parse().ok();
    if number.is_none() {
        reader.fault("wrong-kind", format!("`{key}` must be a whole number"), &found.span);
    }
    number
}
