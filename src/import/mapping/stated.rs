//! A number that a mapping states once, for each section, or where it is to be found.

use super::sections::{self, Sections};
use crate::problem::{Problem, error};
use crate::source::Spanned;
use crate::units::{Unit, number};
use crate::yaml::{Entries, FromNode, Key, Node, Quantity, Reader, Value, fields};

/// `69.02 m`; `{fact: x_start, unit: m}`; `{column: chainage}`; `{S01: 69.02 m, S06: 113 m}`.
#[derive(Clone, Debug)]
pub enum Stated<Q> {
    Number(Q),
    /// A fact of the file or of its table, in a unit.
    Fact(Spanned<String>, Unit),
    /// A column of the table of sections.
    Column(Spanned<String>),
    BySection(Vec<(Key, Q)>),
}

fields! {
    /// A number that the file states.
    struct Fact: "`{key}` from a fact" {
        "fact" fact: Spanned<String>,
        "unit" unit: Spanned<Unit> => "the unit of the fact",
    }
}

fields! {
    /// A number that the table of sections states.
    struct Column: "`{key}` from the table of sections" {
        "column" column: Spanned<String>,
    }
}

impl<'a, Q> FromNode<&'a Sections> for Stated<Q>
where
    Q: Quantity + FromNode<&'a Sections>,
{
    fn from_node(reader: &mut Reader<'_, &'a Sections>, key: &Key, node: &Node) -> Option<Self> {
        if !matches!(node.value, Value::Map(_)) {
            return Q::from_node(reader, key, node).map(Self::Number);
        }
        if node.get("fact").is_some() {
            let Fact { fact, unit } = Fact::from_node(reader, key, node)?;
            let Spanned { value: unit, span } = unit;
            if unit.dimension != Q::unit().dimension {
                let says = format!(
                    "`{}` is {}, and {unit} is {}",
                    key.text,
                    Q::unit().dimension.in_words(),
                    unit.dimension.in_words()
                );
                reader.fault("unit-mismatch", says, &span);
                return None;
            }
            return Some(Self::Fact(fact, unit));
        }
        if node.get("column").is_some() {
            let Column { column } = Column::from_node(reader, key, node)?;
            sections::check_column(reader, &column.value, &column.span);
            return Some(Self::Column(column));
        }
        let Entries(values) = Entries::from_node(reader, key, node)?;
        for (name, _) in &values {
            sections::known(reader, &name.text, &name.span);
        }
        Some(Self::BySection(values))
    }
}

impl<Q: Quantity> Stated<Q> {
    /// The value for a section and where it is from; `None` if it is not stated for this section.
    ///
    /// # Errors
    /// The fact or the cell is missing, or is no number.
    pub fn value(
        &self,
        section: &str,
        sections: &Sections,
        facts: &[(String, String)],
    ) -> Result<Option<f64>, Problem> {
        match self {
            Self::Number(value) => Ok(Some(value.si())),
            Self::BySection(values) => {
                let value = values.iter().find(|(name, _)| name.text == section);
                Ok(value.map(|(_, value)| value.si()))
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
                    error(
                        "wrong-number",
                        format!(
                            "{} `{section}`, `{}`: {}",
                            sections.word, name.value, refused.says
                        ),
                        &name.span,
                    )
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
