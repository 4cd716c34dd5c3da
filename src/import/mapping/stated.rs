//! A number that a mapping states once, for each section, or where it is to be found.

use super::reader::Reader;
use super::sections::{self, Sections};
use crate::problem::Problem;
use crate::source::{Span, Spanned};
use crate::units::{Unit, number};
use crate::yaml::{Node, Value};

/// In SI.
#[derive(Clone, Debug)]
pub enum Stated {
    Number(f64),
    /// A fact of the file or of its table, in a unit.
    Fact(Spanned<String>, Unit),
    /// A column of the table of sections.
    Column(Spanned<String>),
    BySection(Vec<(String, f64)>),
}

/// `69.02 m`; `{fact: x_start, unit: m}`; `{column: chainage}`; `{S01: 69.02 m, S06: 113 m}`.
pub(super) fn read(
    reader: &mut Reader<'_>,
    node: &Node,
    key: &str,
    unit: &Unit,
    sections: &Sections,
) -> Option<Stated> {
    let Value::Map(entries) = &node.value else {
        return reader.number_of(node, key, unit).map(Stated::Number);
    };
    if node.get("fact").is_some() {
        reader.keys(node, &["fact", "unit"], &format!("`{key}` from a fact"));
        let fact = reader.text(node, "fact")?;
        let written = reader.need_text(node, "unit", "the unit of the fact")?;
        let stated = reader.unit(&written)?;
        if stated.dimension != unit.dimension {
            let says = format!(
                "`{key}` is {}, and {stated} is {}",
                unit.dimension.in_words(),
                stated.dimension.in_words()
            );
            reader.fault("unit-mismatch", says, &written.span);
            return None;
        }
        return Some(Stated::Fact(fact, stated));
    }
    if node.get("column").is_some() {
        reader.keys(node, &["column"], &format!("`{key}` from the table of sections"));
        let column = reader.text(node, "column")?;
        if !sections.has_column(&column.value) {
            let problem = Problem::error(
                "unknown-column",
                format!("the table of sections has no column `{}`", column.value),
            );
            reader
                .problems
                .push(problem.at(&column.span).suggest(&column.value, sections.columns()));
            return None;
        }
        return Some(Stated::Column(column));
    }
    let mut found = Vec::new();
    for (name, value) in entries {
        sections::known(reader, sections, &name.text, &name.span);
        found.push((name.text.clone(), reader.number_of(value, key, unit)?));
    }
    Some(Stated::BySection(found))
}

impl Stated {
    /// The value for a section and where it is from; `None` if it is not stated for this section.
    ///
    /// # Errors
    /// The fact or the cell is missing, or is no number.
    pub fn of(
        &self,
        section: &str,
        sections: &Sections,
        facts: &[(String, String)],
    ) -> Result<Option<f64>, Problem> {
        match self {
            Self::Number(value) => Ok(Some(*value)),
            Self::BySection(values) => {
                Ok(values.iter().find(|(name, _)| name == section).map(|(_, value)| *value))
            }
            Self::Column(column) => {
                if sections.cell(section, &column.value).is_some_and(|cell| cell.value.is_empty()) {
                    return Ok(None);
                }
                sections.number(section, &column.value).map(Some)
            }
            Self::Fact(name, unit) => {
                let Some((_, text)) = facts.iter().find(|(known, _)| *known == name.value) else {
                    let problem = Problem::error(
                        "unknown-fact",
                        format!(
                            "{} `{section}`: the file states no `{}`",
                            sections.word, name.value
                        ),
                    );
                    return Err(problem
                        .at(&name.span)
                        .suggest(&name.value, facts.iter().map(|(known, _)| known.as_str())));
                };
                number::read(text, unit).map(|read| Some(read.si)).map_err(|refused| {
                    Problem::error(
                        "wrong-number",
                        format!(
                            "{} `{section}`, `{}`: {}",
                            sections.word, name.value, refused.says
                        ),
                    )
                    .at(&name.span)
                })
            }
        }
    }

    /// For the account of what was done.
    pub fn from_where(&self) -> String {
        match self {
            Self::Number(_) | Self::BySection(_) => "the mapping".into(),
            Self::Fact(name, _) => format!("`{}` of the file", name.value),
            Self::Column(name) => format!("the column `{}` of the table of sections", name.value),
        }
    }
}

/// Where something stands, for problems.
pub(super) fn place(node: Option<&Node>, otherwise: &Span) -> Span {
    node.map_or_else(|| otherwise.clone(), |node| node.span.clone())
}
