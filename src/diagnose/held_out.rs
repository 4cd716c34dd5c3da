//! Sections that the fit never sees: `held out: run = P` in `campaign.yaml`.

use crate::data::{Campaign, campaign::Fact};
use crate::problem::Problem;
use crate::simulate::Section;

/// The key of `campaign.yaml`.
const KEY: &str = "held out";

/// A column of the section table, and the values that mark held-out sections.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HeldOut {
    pub column: String,
    pub values: Vec<String>,
}

/// Sections of the fit, and those that are held out.
pub type Split = (Vec<Section>, Option<(HeldOut, Vec<Section>)>);

impl std::fmt::Display for HeldOut {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} = {}", self.column, self.values.join(", "))
    }
}

impl HeldOut {
    /// Splits the sections into those of the fit and the held-out ones. Nothing is held out where
    /// the campaign does not say so.
    ///
    /// # Errors
    /// `wrong-kind` for a text of another form; `unknown-column`; `no-sections` where no section is
    /// held out, or none is left.
    pub fn split(campaign: &Campaign, sections: Vec<Section>) -> Result<Split, Problem> {
        let named = |fact: &&Fact| fact.group.is_empty() && fact.name.replace('_', " ") == KEY;
        let Some(fact) = campaign.facts.iter().find(named) else { return Ok((sections, None)) };
        let held = Self::read(&fact.text).ok_or_else(|| {
            let says = format!(
                "`{KEY}` must name a column of the section table and its values, not `{}`",
                fact.text
            );
            Problem::error("wrong-kind", says)
                .at(&fact.span)
                .help(format!("for example `{KEY}: run = P`"))
        })?;
        let columns = || {
            sections.iter().flat_map(|section| section.facts.iter().map(|fact| fact.name.as_str()))
        };
        if held.column != "section" && !columns().any(|column| column == held.column) {
            let says = format!(
                "the section table has no column `{}`, by which data are held out",
                held.column
            );
            let known = columns().collect::<std::collections::BTreeSet<_>>();
            return Err(Problem::error("unknown-column", says)
                .at(&fact.span)
                .suggest(&held.column, known));
        }
        let inside = |section: &Section| {
            section
                .fact(&held.column)
                .is_some_and(|value| held.values.iter().any(|one| one == value))
        };
        let missing = held
            .values
            .iter()
            .find(|value| sections.iter().all(|section| section.fact(&held.column) != Some(value)));
        if let Some(missing) = missing {
            let says = format!("no section has `{missing}` in the column `{}`", held.column);
            return Err(Problem::error("no-sections", says).at(&fact.span));
        }
        let (out, kept): (Vec<Section>, Vec<Section>) = sections.into_iter().partition(inside);
        if kept.is_empty() {
            return Err(Problem::error(
                "no-sections",
                format!("`{KEY}: {held}` leaves no section for the fit"),
            )
            .at(&fact.span));
        }
        Ok((kept, Some((held, out))))
    }

    fn read(text: &str) -> Option<Self> {
        let (column, values) = text.split_once('=')?;
        let values: Vec<String> = values.split(',').map(|value| value.trim().to_string()).collect();
        let column = column.trim().to_string();
        (!column.is_empty() && values.iter().all(|value| !value.is_empty()))
            .then_some(Self { column, values })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_and_its_values() {
        let read = |text: &str| HeldOut::read(text).map(|held| held.to_string());
        assert_eq!(read("run = P").as_deref(), Some("run = P"));
        assert_eq!(read("section=S03,S04").as_deref(), Some("section = S03, S04"));
        for wrong in ["run", "run =", "= P", "run = P,, Q", ""] {
            assert_eq!(read(wrong), None, "{wrong}");
        }
    }
}
