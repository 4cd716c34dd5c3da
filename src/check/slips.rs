//! Names in a variant that are one slip away from a name of its parent, and so add something beside
//! what was to be changed.

use super::{Checker, family::Family};
use crate::problem::warning;

/// Names shorter than this differ by one character without a slip: `live`, `alive`.
const SHORTEST: usize = 8;
/// Blocks whose names are symbols, which differ by a letter: `Y_qst`, `B_qst`.
const SYMBOLS: [&str; 3] = ["quantity", "signal", "channel"];

impl Checker<'_> {
    /// A new block of the variant whose name differs from that of a block of the parent by one
    /// character, other than a digit.
    pub fn slips(&mut self, family: &Family) {
        let Some(own) = family.sources.first() else { return };
        for block in
            family.merged.blocks.iter().filter(|block| block.span().source.name == own.name)
        {
            let (kind, name) = (&block.kind.text, block.name_text());
            let siblings = || {
                self.parent_names.iter().filter(|(of, _)| of == kind).map(|(_, name)| name.as_str())
            };
            // A part that is missing may be told of it with the same help.
            let told =
                self.problems.0.iter().any(|problem| problem.at.as_ref() == Some(block.span()));
            if told
                || SYMBOLS.contains(&kind.as_str())
                || name.len() < SHORTEST
                || siblings().any(|known| known == name)
            {
                continue;
            }
            let without_digits =
                |name: &str| name.chars().filter(|c| !c.is_ascii_digit()).collect::<String>();
            let slip = |known: &&str| {
                strsim::damerau_levenshtein(name, known) == 1
                    && without_digits(name) != without_digits(known)
            };
            let Some(near) = siblings().find(slip).map(str::to_string) else { continue };
            self.tell(warning("near-name", format!(
                "the parent has no {kind} `{name}`: this adds one, and `{near}` of the parent stays as it is"
            ), block).help(format!("to override `{near}`, use that name")));
        }
    }
}
