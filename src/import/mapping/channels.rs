//! One channel of the campaign, and what it is made of.

use crate::problem::{Problem, error};
use crate::source::Spanned;
use crate::units::{Unit, number};
use crate::yaml::{FromNode, Key, Node, OneOrMore, Ratio, Reader, Value, fields};

/// A foreign channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    pub name: Spanned<String>,
    pub reversed: bool,
}

/// `Y_1L: -ST1 Y li`, or with more: `Y_1L: {from: ST1 Y li, unit: N, factor: -1.02, offset: 0.3
/// kN}`.
#[derive(Clone, Debug)]
pub struct ChannelMap {
    pub name: Spanned<String>,
    /// The foreign channels; several are summed.
    pub terms: Vec<Term>,
    /// The group, sheet or struct of the channels, where several have a channel of that name.
    pub table: Option<Spanned<String>>,
    /// The unit of the numbers in the file, in place of what the file says.
    pub unit: Option<Spanned<Unit>>,
    pub factor: f64,
    /// Added last.
    pub offset: Option<Spanned<Offset>>,
    /// The unit in the campaign.
    pub written_in: Option<Spanned<Unit>>,
}

#[derive(Clone, Debug)]
pub enum Channels {
    /// Every channel keeps its name.
    AsNamed,
    Maps(Vec<ChannelMap>),
}

impl Channels {
    pub fn maps(&self) -> Option<&[ChannelMap]> {
        if let Self::Maps(maps) = self { Some(maps) } else { None }
    }
}

/// The word that keeps the names.
pub const AS_NAMED: &str = "as named";

fields! {
    /// A channel of which more is stated than its name in the file.
    struct Written: "the channel `{key}`" {
        "from" from: Option<Spanned<String>>,
        "sum of" sum: OneOrMore<Spanned<String>>,
        "table" table: Option<Spanned<String>>,
        "unit" unit: Option<Spanned<Unit>>,
        "factor" factor: Option<Spanned<Ratio>>,
        "offset" offset: Option<Spanned<Offset>>,
        "in" written_in: Option<Spanned<Unit>>,
    }
}

impl<C> FromNode<C> for Channels {
    fn from_node(reader: &mut Reader<'_, C>, _: &Key, node: &Node) -> Option<Self> {
        if node.scalar_text() == Some(AS_NAMED) {
            return Some(Self::AsNamed);
        }
        let Value::Map(entries) = &node.value else {
            let help = format!("write `channels: {AS_NAMED}` if every channel keeps its name");
            reader.tell(node.is_not("`channels`", "a map of channels").help(help));
            return None;
        };
        let maps: Vec<ChannelMap> = entries
            .iter()
            .filter_map(|(key, node)| ChannelMap::from_node(reader, key, node))
            .collect();
        // A sum may use a channel that is also mapped alone; two single channels from one are a
        // slip.
        let single = |map: &ChannelMap| map.terms.len() == 1;
        for (number, map) in maps.iter().enumerate().filter(|(_, map)| single(map)) {
            let source = |map: &ChannelMap| {
                let table = map.table.as_ref().map(|table| table.value.clone());
                (map.terms[0].name.value.clone(), table)
            };
            let same = |first: &&ChannelMap| single(first) && source(first) == source(map);
            if let Some(first) = maps[..number].iter().find(same) {
                let says = format!(
                    "`{}` is mapped twice: to `{}` and to `{}`",
                    map.terms[0].name.value, first.name.value, map.name.value
                );
                reader.tell(
                    error("mapped-twice", says, &map.terms[0].name.span)
                        .also(&first.terms[0].name.span, "the first"),
                );
            }
        }
        Some(Self::Maps(maps))
    }
}

/// A leading `-` reverses the sign of a channel.
impl<C> FromNode<C> for ChannelMap {
    fn from_node(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<Self> {
        let name = Spanned::new(key.text.clone(), key.span.clone());
        if !matches!(node.value, Value::Map(_)) {
            let written = Spanned::from_node(reader, key, node)?;
            return Some(Self::named(name, vec![term(written)]));
        }
        let Written { from, sum, table, unit, factor, offset, written_in } =
            Written::from_node(reader, key, node)?;
        match (&from, sum.0.is_empty()) {
            (Some(from), false) => {
                let says = format!("`{}` is stated by `from` and by `sum of`", key.text);
                reader.fault("contradiction", says, &from.span);
                return None;
            }
            (None, true) => {
                let says = format!("`{}` has no `from`: the channel in the file", key.text);
                reader.fault("key-missing", says, &node.span);
                return None;
            }
            _ => {}
        }
        let terms = from.into_iter().chain(sum.0).map(term).collect();
        if let Some(factor) = factor.as_ref().filter(|factor| factor.value.0 == 0.0) {
            let says = "a factor of 0 would make a channel without a signal";
            reader.fault("out-of-range", says, &factor.span);
        }
        if let (Some(stated), Some(written)) = (&unit, &written_in)
            && stated.value.dimension != written.value.dimension
        {
            let says = format!(
                "`{}` is {} in the file and {} in the campaign",
                key.text,
                stated.value.dimension.in_words(),
                written.value.dimension.in_words()
            );
            reader.tell(
                error("unit-mismatch", says, &written.span).also(&stated.span, "in the file"),
            );
        }
        let factor = factor.map_or(1.0, |factor| factor.value.0);
        Some(Self { table, unit, factor, offset, written_in, ..Self::named(name, terms) })
    }
}

/// What is added to a channel, in SI. It must state its unit: it is added in the campaign, where
/// the unit may be another than in the file.
#[derive(Clone, Debug)]
pub struct Offset {
    pub si: f64,
    /// As written.
    pub unit: Unit,
}

impl<C> FromNode<C> for Offset {
    fn from_node(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<Self> {
        let text = String::from_node(reader, key, node)?;
        let split = number::split(&text, &Unit::one()).map_err(|refused| Problem {
            help: refused.help,
            ..error("wrong-number", format!("`offset`: {}", refused.says), &node.span)
        });
        let (number, unit) = reader.keep(split)?;
        if unit.is_empty() {
            let problem = error("unit-missing", "the offset has no unit", &node.span);
            reader.tell(problem.help(format!("write it, for instance `{text} kN`")));
            return None;
        }
        let unit = reader.unit(unit, &node.span)?;
        Some(Self { si: unit.to_si(number), unit })
    }
}

fn term(written: Spanned<String>) -> Term {
    match written.value.strip_prefix('-') {
        Some(rest) if !rest.trim().is_empty() => {
            let cut = written.value.len() - rest.trim_start().len();
            let span = written.span.part(cut..written.value.len());
            Term { name: Spanned::new(rest.trim().to_string(), span), reversed: true }
        }
        _ => Term { name: written, reversed: false },
    }
}

impl ChannelMap {
    /// A channel that is the sum of others, as they are.
    pub fn named(name: Spanned<String>, terms: Vec<Term>) -> Self {
        Self { name, terms, table: None, unit: None, factor: 1.0, offset: None, written_in: None }
    }

    /// `-1.02 (ST1 Y li) + 0.3 kN`, for the account of what was done.
    pub fn in_words(&self) -> String {
        let one =
            |term: &Term| format!("{}{}", if term.reversed { "-" } else { "" }, term.name.value);
        let mut words =
            self.terms.iter().map(one).collect::<Vec<_>>().join(" + ").replace("+ -", "- ");
        if self.factor != 1.0 {
            words = format!("{} ({words})", self.factor);
        }
        if let Some(offset) = &self.offset {
            let Offset { si, unit } = &offset.value;
            words += &format!(" + {} {unit}", unit.from_si(*si));
        }
        match &self.unit {
            Some(unit) => format!("{words}, read in {}", unit.value),
            None => words,
        }
    }
}
