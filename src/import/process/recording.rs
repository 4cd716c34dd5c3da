//! The recording of a section: the channels of a mapping in its file, and their units.

use std::sync::Arc;

use super::store::Store;
use crate::foreign::{Channel, File, Table};
use crate::import::mapping::{ChannelMap, Mapping, Side, agree};
use crate::problem::{Problem, error};
use crate::run::needs::Needs;
use crate::source::{Span, Spanned};
use crate::units::{Dimension, Unit};

/// One side of a section or a run, and the file that it is read from.
#[derive(Clone, Debug)]
pub struct Recording<'a> {
    pub mapping: &'a Mapping,
    pub side: &'a Side,
    pub needs: Option<&'a Needs>,
    pub section: &'a str,
    /// Where the values of long records wait; they are held in memory if there is none.
    pub store: Option<&'a Arc<Store>>,
    /// Name of the file in messages.
    pub shown: &'a str,
    /// The tables of the section in the file: that with the name stated, or all.
    pub tables: Vec<&'a Table>,
    /// What the tables and the file say of themselves.
    pub facts: Vec<(String, String)>,
}

impl<'a> Recording<'a> {
    /// A section in a file that is read, with its name in messages.
    ///
    /// # Errors
    /// `unknown-table`.
    pub fn new(
        (mapping, side): (&'a Mapping, &'a Side),
        needs: Option<&'a Needs>,
        section: &'a str,
        (file, shown): &'a (File, String),
        store: Option<&'a Arc<Store>>,
    ) -> Result<Self, Problem> {
        let (tables, facts) = (file.tables.iter().collect(), Vec::new());
        let mut recording = Self { mapping, side, needs, section, store, shown, tables, facts };
        if let Some(pattern) = &side.table {
            recording.tables = recording.tables_named(pattern)?;
        }
        let facts = recording.tables.iter().flat_map(|table| &table.facts).chain(&file.facts);
        recording.facts = facts.cloned().collect();
        Ok(recording)
    }

    /// An error of this section or run.
    pub fn fault(&self, code: &'static str, says: &str, at: &Span) -> Problem {
        let word = self.mapping.sections.word;
        error(code, format!("{word} `{}`: {says}", self.section), at)
    }

    /// The error that a table has no time.
    pub fn time_missing(&self) -> Problem {
        error("time-missing", format!("`{}` has no time", self.shown), &self.side.time.span)
    }

    /// The tables with a name, which may hold placeholders.
    fn tables_named(&self, pattern: &Spanned<String>) -> Result<Vec<&'a Table>, Problem> {
        let wanted = self.mapping.sections.fill(&pattern.value, self.section);
        let named = self.tables.iter().copied().filter(|table| table.name == wanted);
        let named: Vec<&Table> = named.collect();
        if named.is_empty() {
            let says = format!("`{}` has no table `{wanted}`", self.shown);
            let known = self.tables.iter().map(|table| table.name.as_str());
            return Err(error("unknown-table", says, &pattern.span).suggest(&wanted, known));
        }
        Ok(named)
    }

    /// What the mapping says that a unit text of the file means.
    pub fn stated_unit(&self, text: &str) -> Option<Unit> {
        let mut units = self.side.units.iter();
        units.find(|(known, _)| known.text == text).map(|(_, unit)| unit.clone())
    }

    /// The unit of the numbers of a channel, which must be of the dimension of the campaign's
    /// channel, if that is known.
    fn unit(
        &self,
        map: &ChannelMap,
        name: &Spanned<String>,
        channel: &Channel,
        wanted: Option<&Unit>,
    ) -> Result<Unit, Problem> {
        // Of another dimension than wanted, in words.
        let mismatch = |unit: &Unit| {
            let wanted = wanted.filter(|wanted| wanted.dimension != unit.dimension)?;
            let (is, not) = (wanted.dimension.in_words(), unit.dimension.in_words());
            Some(format!("`{}` is {is} ({wanted}), and {unit} is {not}", map.name.value))
        };
        if let Some(unit) = &map.unit {
            return match mismatch(&unit.value) {
                Some(says) => Err(error("unit-mismatch", says, &unit.span)),
                None => Ok(unit.value.clone()),
            };
        }
        let write = |problem: Problem| {
            let example = wanted.map_or("...", |unit| unit.text.as_str());
            let (name, mut from) = (&map.name.value, name.value.clone());
            // Within braces, these end a word.
            if from.contains([',', '[', ']', '{', '}', ':']) {
                from = format!("\"{from}\"");
            }
            problem.help(format!("write it: `{name}: {{from: {from}, unit: {example}}}`"))
        };
        if let Some(says) = two_units(channel, self.shown) {
            return Err(write(error("unit-conflict", says, &name.span)));
        }
        let text = channel.unit.as_deref().map(str::trim).filter(|text| !text.is_empty());
        let Some(text) = text else {
            if wanted.is_some_and(|wanted| wanted.dimension == Dimension::ONE) {
                return Ok(Unit::one());
            }
            let says = format!("`{}` states no unit of `{}`", self.shown, name.value);
            return Err(write(error("unit-missing", says, &name.span)));
        };
        let unit = self.stated_unit(text).map_or_else(|| Unit::parse(text), Ok);
        let unit = unit.map_err(|unknown| {
            let says =
                format!("`{}`: the unit `{text}` of `{}` is not known", self.shown, name.value);
            // Of the dimension that is wanted, or one that is written in another way.
            let dimension = |text: &str| Unit::parse(text).ok().map(|unit| unit.dimension);
            let fits = |near: &str| {
                let found = dimension(near);
                found.is_some() && wanted.is_some_and(|wanted| found == Some(wanted.dimension))
            };
            let powers = text.replace("**", "^");
            let near = match unknown.near.filter(|near| fits(near)) {
                _ if dimension(&powers).is_some() => &powers,
                near => near.unwrap_or("..."),
            };
            error("unknown-unit", says, &name.span)
                .help(format!("say what it means: `units: {{\"{text}\": {near}}}`"))
        })?;
        let Some(says) = mismatch(&unit) else { return Ok(unit) };
        let help = if wanted.is_some_and(|wanted| agree::is_gravity(text, wanted)) {
            "`g` is the gram; of accelerations in units of gravity, write `units: {g: gn}`"
        } else {
            "check the name of the channel; if the file states a wrong unit, write the right one: `unit: ...`"
        };
        Err(error("unit-mismatch", format!("`{}`: {says}", self.shown), &name.span).help(help))
    }

    /// The unit of a channel in the campaign, where the mapping or the protocol says it.
    pub fn target(&self, map: &ChannelMap) -> Option<Unit> {
        agree::target(map, self.side.kind, self.needs)
    }

    /// The number of the one table that has a channel, and the channel.
    pub fn find(
        &self,
        name: &Spanned<String>,
        table: Option<&Spanned<String>>,
    ) -> Result<(usize, &'a Channel), Problem> {
        let within: Vec<&Table> = match table {
            Some(pattern) => self.tables_named(pattern)?,
            None => self.tables.clone(),
        };
        let is_within = |table: &Table| within.iter().any(|one| std::ptr::eq(*one, table));
        let tables = self.tables.iter().copied().enumerate().filter(|(_, table)| is_within(table));
        let found: Vec<(usize, &Channel)> = tables
            .flat_map(|(number, table)| table.channels.iter().map(move |one| (number, one)))
            .filter(|(_, channel)| channel.name == name.value)
            .collect();
        match found[..] {
            [one] => Ok(one),
            [] => {
                let mut left_out = self.tables.iter().flat_map(|table| &table.left_out);
                if let Some((_, why)) = left_out.find(|(known, _)| *known == name.value) {
                    let says = format!("`{}` of `{}` is no channel: {why}", name.value, self.shown);
                    return Err(error("no-channel", says, &name.span));
                }
                let known = within.iter().flat_map(|table| &table.channels);
                let known = known.map(|channel| channel.name.as_str());
                let says = format!("`{}` has no channel `{}`", self.shown, name.value);
                let problem = error("unknown-channel", says, &name.span);
                Err(nearest_or_first(problem, &name.value, known))
            }
            [(first, _), (second, _), ..] => {
                let says = format!("`{}` has `{}` several times", self.shown, name.value);
                let (one, two) = (&self.tables[first].name, &self.tables[second].name);
                let problem = error("ambiguous-channel", says, &name.span);
                Err(if one == two {
                    problem.help("export it with a name of its own")
                } else {
                    problem.help(format!(
                        "say which: `{{from: {}, table: {one}}}`, or `table: {two}`",
                        name.value
                    ))
                })
            }
        }
    }
}

/// That a file states two units of a channel.
pub fn two_units(channel: &Channel, shown: &str) -> Option<String> {
    let (one, other) = channel.unit.as_ref().zip(channel.other_unit.as_ref())?;
    Some(format!("`{shown}` states two units of `{}`: {one} and {other}", channel.name))
}

/// Names the channel that may be meant, else the first ones of the file.
pub fn nearest_or_first<'a>(
    problem: Problem,
    name: &str,
    known: impl Iterator<Item = &'a str>,
) -> Problem {
    /// Channels that are named.
    const SHOWN: usize = 12;
    let known: Vec<&str> = known.collect();
    let problem = problem.suggest(name, known.iter().copied());
    if problem.help.is_some() || known.is_empty() {
        return problem;
    }
    let more = known.len().saturating_sub(SHOWN);
    problem.help(format!(
        "its first channels are {}, and there are {more} more",
        known[..known.len() - more].join(", ")
    ))
}

/// The channels of a file that a channel of the campaign is made of, all in one table.
#[derive(Debug)]
pub struct Source<'a> {
    /// The number of the table.
    pub table: usize,
    /// Each with its unit and its sign.
    terms: Vec<(&'a Channel, Unit, f64)>,
}

impl<'a> Source<'a> {
    /// Finds the channels and their units.
    pub fn find(
        recording: &Recording<'a>,
        map: &ChannelMap,
        wanted: Option<&Unit>,
    ) -> Result<Self, Problem> {
        let mut first = None;
        let mut terms = Vec::new();
        for term in &map.terms {
            let (table, channel) = recording.find(&term.name, map.table.as_ref())?;
            let unit = recording.unit(map, &term.name, channel, wanted)?;
            let first = *first.get_or_insert(table);
            if first != table {
                let [one, other] = [first, table].map(|table| &recording.tables[table].name);
                let says = format!(
                    "`{}` is a sum of channels of different tables: `{one}` and `{other}`",
                    map.name.value
                );
                return Err(error("sum-of-tables", says, &term.name.span));
            }
            terms.push((channel, unit, if term.reversed { -1.0 } else { 1.0 }));
        }
        let stated = || error("key-missing", "no channel is stated", &map.name.span);
        Ok(Self { table: first.ok_or_else(stated)?, terms })
    }

    /// The unit of the first channel in the file.
    pub fn unit(&self) -> &Unit {
        &self.terms[0].1
    }

    /// The values in SI.
    pub fn values(&self, map: &ChannelMap) -> Vec<f64> {
        let mut sum: Vec<f64> = Vec::new();
        for (number, (channel, unit, sign)) in self.terms.iter().enumerate() {
            let values = channel.values.iter().map(|value| sign * unit.to_si(*value));
            match number {
                0 => sum = values.collect(),
                _ => sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += value),
            }
        }
        let offset = map.offset.as_ref().map_or(0.0, |offset| offset.value.si);
        if map.factor != 1.0 || offset != 0.0 {
            sum.iter_mut().for_each(|value| *value = map.factor * *value + offset);
        }
        sum
    }
}
