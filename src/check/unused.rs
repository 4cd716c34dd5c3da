//! Parameters, definitions and estimates that no rule uses.

use std::collections::BTreeSet;

use super::{Checker, family::Family};
use crate::problem::warning;
use crate::syntax::{
    document::Block,
    keys::{self, Sort},
};

/// What is there to be used by other rules.
const NAMED: [&str; 3] = ["parameter", "define", "estimate"];

impl Checker<'_> {
    /// Warns of those in the text itself. What a parent has may be there for other variants, and a
    /// text without quantities is there for the protocols that use it.
    pub fn unused(&mut self, family: &Family) {
        let Some(own) = family.sources.first() else { return };
        let blocks = &family.merged.blocks;
        if blocks.iter().all(|block| block.kind.text != "quantity") {
            return;
        }
        let (mut unused, mut open): (Vec<&Block>, Vec<&Block>) =
            blocks.iter().partition(|block| NAMED.contains(&block.kind.text.as_str()));
        while let Some(block) = open.pop() {
            let words = words(block);
            let (used, rest) =
                unused.into_iter().partition(|named| words.contains(named.name_text()));
            open.extend::<Vec<&Block>>(used);
            unused = rest;
        }
        for block in unused.into_iter().filter(|block| block.span().source.name == own.name) {
            // A slip in its name has been told.
            if self.problems.0.iter().any(|problem| problem.at.as_ref() == Some(block.span())) {
                continue;
            }
            let says = format!("no rule uses the {} `{}`", block.kind.text, block.name_text());
            let help = "use its name in a rule, or remove the block";
            self.tell(warning("unused", says, block).help(help));
        }
    }
}

/// The words in the phrases of a block. Some are no names; a name that is used is among them.
fn words(block: &Block) -> BTreeSet<&str> {
    let kind = keys::of_block(block);
    let phrases = block.fields.iter().filter(|field| {
        let key = kind.and_then(|kind| kind.key(&field.key.text));
        key.is_some_and(|key| key.sort == Sort::Phrase)
    });
    phrases
        .flat_map(|field| {
            field.value.text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))
        })
        .collect()
}
