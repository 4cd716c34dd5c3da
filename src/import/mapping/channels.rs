//! One channel of the campaign, and what it is made of.

use super::reader::Reader;
use crate::problem::Problem;
use crate::source::Spanned;
use crate::units::{Unit, number};
use crate::yaml::{Key, Node, Value};

const KEYS: [&str; 7] = ["from", "sum of", "table", "unit", "factor", "offset", "in"];

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
    /// Added last, with the unit it was written in, in SI.
    pub offset: Option<Spanned<(f64, Unit)>>,
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

pub(super) fn read(reader: &mut Reader<'_>, node: &Node) -> Option<Channels> {
    if node.scalar_text() == Some(AS_NAMED) {
        return Some(Channels::AsNamed);
    }
    let Value::Map(entries) = &node.value else {
        let problem = Problem::error(
            "wrong-kind",
            format!("`channels` must be a map of channels, not {}", node.kind_in_words()),
        );
        reader.problems.push(
            problem
                .at(&node.span)
                .help(format!("write `channels: {AS_NAMED}` if every channel keeps its name")),
        );
        return None;
    };
    let maps: Vec<ChannelMap> =
        entries.iter().filter_map(|(key, node)| channel_map(reader, key, node)).collect();
    // A sum may use a channel that is also mapped alone; two single channels from one are a slip.
    let single = |map: &ChannelMap| map.terms.len() == 1;
    for (number, map) in maps.iter().enumerate().filter(|(_, map)| single(map)) {
        let same = |first: &&ChannelMap| {
            let table = |map: &ChannelMap| map.table.as_ref().map(|table| table.value.clone());
            single(first)
                && first.terms[0].name.value == map.terms[0].name.value
                && table(first) == table(map)
        };
        if let Some(first) = maps[..number].iter().find(same) {
            let says = format!(
                "`{}` is mapped twice: to `{}` and to `{}`",
                map.terms[0].name.value, first.name.value, map.name.value
            );
            reader.problems.push(
                Problem::error("mapped-twice", says)
                    .at(&map.terms[0].name.span)
                    .also(&first.terms[0].name.span, "the first"),
            );
        }
    }
    Some(Channels::Maps(maps))
}

/// One entry. A leading `-` reverses the sign of a channel.
pub(super) fn channel_map(reader: &mut Reader<'_>, key: &Key, node: &Node) -> Option<ChannelMap> {
    let name = Spanned::new(key.text.clone(), key.span.clone());
    let plain = |terms| ChannelMap {
        name: name.clone(),
        terms,
        table: None,
        unit: None,
        factor: 1.0,
        offset: None,
        written_in: None,
    };
    if !matches!(node.value, Value::Map(_)) {
        let written = reader.text_of(node, &key.text)?;
        return Some(plain(vec![term(written)]));
    }
    reader.keys(node, &KEYS, &format!("the channel `{}`", key.text));
    let mut terms: Vec<Term> = reader.texts(node, "sum of").into_iter().map(term).collect();
    match (reader.text(node, "from"), terms.is_empty()) {
        (Some(from), true) => terms.push(term(from)),
        (None, false) => {}
        (Some(from), false) => {
            reader.fault(
                "contradiction",
                format!("`{}` is stated by `from` and by `sum of`", key.text),
                &from.span,
            );
            return None;
        }
        (None, true) => {
            let problem = Problem::error(
                "key-missing",
                format!("`{}` has no `from`: the channel in the file", key.text),
            )
            .at(&node.span);
            reader.problems.push(problem);
            return None;
        }
    }
    let table = reader.text(node, "table");
    let mut unit = |key: &str| {
        let written = reader.text(node, key)?;
        Some(Spanned::new(reader.unit(&written)?, written.span))
    };
    let (stated, written_in) = (unit("unit"), unit("in"));
    let factor = reader.number(node, "factor", &Unit::one()).unwrap_or(1.0);
    if factor == 0.0 {
        let at = super::stated::place(node.get("factor"), &node.span);
        reader.fault("out-of-range", "a factor of 0 would make a channel without a signal", &at);
    }
    let offset = offset(reader, node);
    if let (Some(stated), Some(written)) = (&stated, &written_in)
        && stated.value.dimension != written.value.dimension
    {
        let says = format!(
            "`{}` is {} in the file and {} in the campaign",
            key.text,
            stated.value.dimension.in_words(),
            written.value.dimension.in_words()
        );
        reader.problems.push(
            Problem::error("unit-mismatch", says)
                .at(&written.span)
                .also(&stated.span, "in the file"),
        );
    }
    Some(ChannelMap { table, unit: stated, factor, offset, written_in, ..plain(terms) })
}

/// An offset must state its unit: it is added in the campaign, where the unit may be another than
/// in the file.
fn offset(reader: &mut Reader<'_>, node: &Node) -> Option<Spanned<(f64, Unit)>> {
    let written = reader.text(node, "offset")?;
    if written.value.contains(',')
        && let Err(number::Refused { says, help: Some(help) }) =
            number::read(&written.value, &Unit::one())
    {
        reader.problems.push(
            Problem::error("wrong-number", format!("`offset`: {says}"))
                .at(&written.span)
                .help(help),
        );
        return None;
    }
    let at = written
        .value
        .find(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c)))
        .unwrap_or(written.value.len());
    let unit = written.value[at..].trim();
    if unit.is_empty() {
        let problem = Problem::error("unit-missing", "the offset has no unit").at(&written.span);
        reader
            .problems
            .push(problem.help(format!("write it, for instance `{} kN`", written.value)));
        return None;
    }
    let unit = reader.unit(&Spanned::new(unit.to_string(), written.span.clone()))?;
    match number::read(&written.value, &unit) {
        Ok(read) => Some(Spanned::new((read.si, unit), written.span)),
        Err(refused) => {
            reader.fault("wrong-number", format!("`offset`: {}", refused.says), &written.span);
            None
        }
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
            words += &format!(" + {} {}", offset.value.1.from_si(offset.value.0), offset.value.1);
        }
        match &self.unit {
            Some(unit) => format!("{words}, read in {}", unit.value),
            None => words,
        }
    }
}
