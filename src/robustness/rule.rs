//! A rule of a protocol found by its address, and the protocol with another value for it.

use crate::check::family::Family;
use crate::problem::Problem;
use crate::source::Source;
use crate::syntax::{
    document::{Block, Document, Field, Text},
    keys,
};

/// One field of one block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rule {
    /// The address: `quantity NAME limit std`.
    words: String,
    block: usize,
    field: usize,
    /// Words of the field's value that are part of the address: `std`.
    stays: String,
    /// The rest of the present value.
    pub as_it_is: String,
    pub title: String,
}

impl Rule {
    /// Finds a field by the kind of block, its name, a key and the first words of the value.
    ///
    /// # Errors
    /// No such block, no such field, or several of them; the message lists the available ones.
    pub fn find(document: &Document, address: &str) -> Result<Self, Problem> {
        let words: Vec<&str> = address.split_whitespace().collect();
        let wrong = |says: String| Problem::error("unknown-rule", says);
        let kind = words[0];
        let Some(known) = keys::kind(kind) else {
            let kinds = document.blocks.iter().map(|block| block.kind.text.as_str());
            let problem = wrong(format!("`--vary {address}`: a protocol has no block `{kind}`"))
                .suggest(kind, kinds);
            return Err(problem.help("write a parameter's name, or a block, its name and a key: `quantity <name> limit std`"));
        };
        let named = words.get(1).is_some_and(|name| {
            document
                .blocks
                .iter()
                .any(|block| block.kind.text == kind && block.name_text() == *name)
        });
        let known = known.with_name(known.named || named);
        let (name, rest) = if known.named {
            (words.get(1).copied().unwrap_or(""), words.get(2..))
        } else {
            ("", words.get(1..))
        };
        let rest = rest.unwrap_or(&[]);
        let block_words = if known.named { format!("{kind} {name}") } else { kind.to_owned() };
        let same = |block: &&Block| {
            block.kind.text == kind
                && block.name.is_some() == known.named
                && (!known.named || block.name_text() == name)
        };
        let Some((at, block)) = document.blocks.iter().enumerate().find(|(_, block)| same(block))
        else {
            let names: Vec<&str> = document
                .blocks
                .iter()
                .filter(|block| block.kind.text == kind)
                .map(Block::name_text)
                .collect();
            return Err(wrong(format!("`--vary {address}`: the protocol has no {kind} `{name}`"))
                .suggest(name, names));
        };
        let fields: Vec<(usize, String)> = block
            .fields
            .iter()
            .enumerate()
            .filter_map(|(at, field)| stays(field, rest).map(|stays| (at, stays)))
            .collect();
        match fields.as_slice() {
            [(field, stays)] => {
                let value = joined(block.fields[*field].value.text.split_whitespace());
                let title = block
                    .title
                    .as_ref()
                    .map_or_else(|| block_words.clone(), |title| title.text.clone());
                Ok(Self {
                    words: joined(words.iter().copied()),
                    block: at,
                    field: *field,
                    as_it_is: value[stays.len()..].trim_start().to_owned(),
                    stays: stays.clone(),
                    title: format!("{title}: {}", rest.join(" ")),
                })
            }
            [] => {
                let has: Vec<&str> =
                    block.fields.iter().map(|field| field.key.text.as_str()).collect();
                let key = rest.first().copied().unwrap_or("");
                Err(wrong(format!(
                    "`--vary {address}`: {block_words} has no rule `{}`",
                    rest.join(" ")
                ))
                .suggest(key, has))
            }
            several => {
                let each = several.iter().map(|(at, _)| {
                    format!("`{} {}`", block.fields[*at].key.text, block.fields[*at].value.text)
                });
                let help = format!(
                    "add the first words of one of them: {}",
                    each.collect::<Vec<_>>().join(", ")
                );
                Err(wrong(format!("`--vary {address}` matches several rules")).help(help))
            }
        }
    }

    /// The protocol with another value of the rule; problems with it point to the command line.
    pub fn with(&self, family: &Family, value: &str) -> Family {
        let mut family = family.clone();
        let source = Source::new("--vary", format!("{} {value}", self.words));
        let text = if self.stays.is_empty() {
            value.to_owned()
        } else {
            format!("{} {value}", self.stays)
        };
        let span = source.span(source.text.len() - text.len()..source.text.len());
        family.merged.blocks[self.block].fields[self.field].value =
            Text { text, span, exact: true };
        family
    }
}

/// The part of a field's value that the words after its key address, if they match.
fn stays(field: &Field, words: &[&str]) -> Option<String> {
    let key: Vec<&str> = field.key.text.split_whitespace().collect();
    let first = words.strip_prefix(key.as_slice())?;
    let value: Vec<&str> = field.value.text.split_whitespace().collect();
    value.starts_with(first).then(|| first.join(" "))
}

fn joined<'a>(words: impl Iterator<Item = &'a str>) -> String {
    words.collect::<Vec<_>>().join(" ")
}
