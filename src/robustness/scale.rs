//! All limits of one statistic of a protocol, multiplied by a common factor.

use crate::check::family::Family;
use crate::problem::{Problem, Problems};
use crate::syntax::document::{Document, Text};

/// The limits addressed by `every limit std`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scale {
    /// The address.
    words: String,
    statistic: String,
    /// Block and field of each limit.
    limits: Vec<(usize, usize)>,
}

impl Scale {
    /// Whether an address is of this form.
    pub fn asked(address: &str) -> bool {
        address.split_whitespace().next() == Some("every")
    }

    /// Finds the limits addressed by `every limit` and a statistic.
    ///
    /// # Errors
    /// Another address, or a statistic without a limit; the message lists those that have one.
    pub fn find(document: &Document, address: &str) -> Result<Self, Problem> {
        let wrong =
            |says: String| Problem::error("unknown-rule", format!("`--vary {address}`: {says}"));
        let [_, "limit", statistic] = address.split_whitespace().collect::<Vec<_>>()[..] else {
            let says = "`every` must be followed by `limit` and a statistic".to_owned();
            return Err(wrong(says).help("write `every limit std`, with factors as its values"));
        };
        let fields = document.blocks.iter().enumerate().flat_map(|(at, block)| {
            let limits =
                block.fields.iter().enumerate().filter(|(_, field)| field.key.text == "limit");
            limits.map(move |(field, found)| {
                ((at, field), found.value.text.split_whitespace().next().unwrap_or(""))
            })
        });
        let (limits, others): (Vec<_>, Vec<_>) = fields.partition(|(_, of)| *of == statistic);
        if limits.is_empty() {
            let says = format!("the protocol has no limit of `{statistic}`");
            return Err(wrong(says).suggest(statistic, others.iter().map(|(_, of)| *of)));
        }
        let limits = limits.into_iter().map(|(place, _)| place).collect();
        Ok(Self {
            words: format!("every limit {statistic}"),
            statistic: statistic.to_owned(),
            limits,
        })
    }

    /// The protocol with every such limit multiplied by a factor. Limits that are shares of them
    /// change accordingly.
    pub fn with(&self, family: &Family, value: &str, problems: &mut Problems) -> Option<Family> {
        let Some(factor) =
            value.trim().parse::<f64>().ok().filter(|factor| factor.is_finite() && *factor > 0.0)
        else {
            let says =
                format!("`--vary {}={value}`: `{value}` is not a number above zero", self.words);
            problems.push(Problem::error("vary", says).help(
                "the values are factors without a unit: `every limit std=0.8..1.2 step 0.1`",
            ));
            return None;
        };
        let mut family = family.clone();
        for &(block, field) in &self.limits {
            let limit = &mut family.merged.blocks[block].fields[field].value;
            // In the language's own words, so that the report prints the limit that was used.
            *limit = Text {
                text: format!("{}, times {factor} when true", limit.text),
                span: limit.span.clone(),
                exact: false,
            };
        }
        Some(family)
    }

    pub fn title(&self) -> String {
        format!("Every limit of {}, times a factor", self.statistic)
    }
}
