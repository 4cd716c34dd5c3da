//! Finds the channels of a mapping in a file, and their units.

use std::sync::Arc;

use super::store::Store;
use crate::foreign::{Channel, File, Table};
use crate::import::mapping::{ChannelMap, Mapping, Side, agree};
use crate::problem::Problem;
use crate::run::needs::Needs;
use crate::source::Spanned;
use crate::units::{Dimension, Unit};

/// A section of one side, and the file that it is read from.
#[derive(Clone, Copy, Debug)]
pub struct Of<'a> {
    pub mapping: &'a Mapping,
    pub side: &'a Side,
    pub needs: Option<&'a Needs>,
    pub section: &'a str,
    pub file: &'a File,
    /// Where the values of long records wait; they are held in memory if there is none.
    pub store: Option<&'a Arc<Store>>,
    /// Name of the file in messages.
    pub shown: &'a str,
}

/// A channel and the number of its table.
#[derive(Clone, Copy, Debug)]
pub struct Found<'a> {
    pub table: usize,
    pub channel: &'a Channel,
}

impl<'a> Of<'a> {
    /// The section or the run, for messages.
    pub fn called(&self) -> String {
        format!("{} `{}`", self.mapping.sections.word, self.section)
    }

    /// The tables of the section: that with the name stated, or all.
    pub fn tables(&self) -> Result<Vec<&'a Table>, Problem> {
        let Some(pattern) = &self.side.table else { return Ok(self.file.tables.iter().collect()) };
        let wanted = self.mapping.sections.fill(&pattern.value, self.section);
        let found: Vec<&Table> =
            self.file.tables.iter().filter(|table| table.name == wanted).collect();
        if found.is_empty() {
            let problem = Problem::error(
                "unknown-table",
                format!("`{}` has no table `{wanted}`", self.shown),
            )
            .at(&pattern.span);
            return Err(
                problem.suggest(&wanted, self.file.tables.iter().map(|table| table.name.as_str()))
            );
        }
        Ok(found)
    }

    /// The unit of the numbers of a channel, which must be of the dimension of the campaign's
    /// channel, if that is known.
    pub fn unit(
        &self,
        map: &ChannelMap,
        name: &Spanned<String>,
        channel: &Channel,
        wanted: Option<&Unit>,
    ) -> Result<Unit, Problem> {
        if let Some(unit) = &map.unit {
            return checked(&unit.value, wanted, || {
                Problem::error("unit-mismatch", mismatch(&map.name.value, &unit.value, wanted))
                    .at(&unit.span)
            });
        }
        let text = channel.unit.as_deref().map(str::trim).filter(|text| !text.is_empty());
        let Some(text) = text else {
            if wanted.is_some_and(|wanted| wanted.dimension == Dimension::ONE) {
                return Ok(Unit::one());
            }
            let problem = Problem::error(
                "unit-missing",
                format!("`{}` states no unit of `{}`", self.shown, name.value),
            )
            .at(&name.span);
            let example = wanted.map_or_else(|| "...".to_string(), |unit| unit.text.clone());
            return Err(problem.help(format!(
                "write it: `{}: {{from: {}, unit: {example}}}`",
                map.name.value, name.value
            )));
        };
        let stated = self
            .side
            .units
            .iter()
            .find(|(known, _)| known.text == text)
            .map(|(_, unit)| unit.clone());
        let unit = stated.map_or_else(|| Unit::parse(text), Ok).map_err(|unknown| {
            let problem = Problem::error(
                "unknown-unit",
                format!("`{}`: the unit `{text}` of `{}` is not known", self.shown, name.value),
            )
            .at(&name.span);
            let near = unknown.near.map_or_else(|| "...".to_string(), str::to_string);
            problem.help(format!("say what it means: `units: {{\"{text}\": {near}}}`"))
        })?;
        checked(&unit, wanted, || {
            let says = format!("`{}`: {}", self.shown, mismatch(&map.name.value, &unit, wanted));
            let problem = Problem::error("unit-mismatch", says).at(&name.span);
            let gravity = wanted.filter(|wanted| agree::is_gravity(text, wanted));
            match gravity {
                Some(_) => problem.help("`g` is the gram; of accelerations in units of gravity, write `units: {g: gn}`"),
                None => problem.help("check the name of the channel; if the file states a wrong unit, write the right one: `unit: ...`"),
            }
        })
    }

    /// The unit of a channel in the campaign, where the mapping or the protocol says it.
    pub fn target(&self, map: &ChannelMap) -> Option<Unit> {
        agree::target(map, self.side.kind, self.needs)
    }
}

/// The channel with a name, in the one table that has it.
pub fn find<'a>(
    of: &Of<'_>,
    tables: &[&'a Table],
    name: &Spanned<String>,
    table: Option<&Spanned<String>>,
) -> Result<Found<'a>, Problem> {
    let wanted =
        table.map(|table| (of.mapping.sections.fill(&table.value, of.section), &table.span));
    if let Some((wanted, span)) =
        wanted.as_ref().filter(|(wanted, _)| !tables.iter().any(|table| table.name == *wanted))
    {
        let problem =
            Problem::error("unknown-table", format!("`{}` has no table `{wanted}`", of.shown))
                .at(span);
        return Err(problem.suggest(wanted, tables.iter().map(|table| table.name.as_str())));
    }
    let within = |table: &Table| wanted.as_ref().is_none_or(|(wanted, _)| table.name == *wanted);
    let mut found: Vec<Found<'a>> = Vec::new();
    for (number, table) in tables.iter().enumerate().filter(|(_, table)| within(table)) {
        found.extend(
            table
                .channels
                .iter()
                .filter(|channel| channel.name == name.value)
                .map(|channel| Found { table: number, channel }),
        );
    }
    match found[..] {
        [one] => Ok(one),
        [] => {
            let left_out = tables
                .iter()
                .flat_map(|table| &table.left_out)
                .find(|(known, _)| *known == name.value);
            if let Some((_, why)) = left_out {
                return Err(Problem::error(
                    "no-channel",
                    format!("`{}` of `{}` is no channel: {why}", name.value, of.shown),
                )
                .at(&name.span));
            }
            let known = tables
                .iter()
                .filter(|table| within(table))
                .flat_map(|table| table.channels.iter().map(|channel| channel.name.as_str()));
            let problem = Problem::error(
                "unknown-channel",
                format!("`{}` has no channel `{}`", of.shown, name.value),
            )
            .at(&name.span);
            Err(nearest_or_first(problem, &name.value, known))
        }
        [first, second, ..] => {
            let says = format!("`{}` has `{}` several times", of.shown, name.value);
            let (one, two) = (&tables[first.table].name, &tables[second.table].name);
            let problem = Problem::error("ambiguous-channel", says).at(&name.span);
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

fn checked(
    unit: &Unit,
    wanted: Option<&Unit>,
    problem: impl FnOnce() -> Problem,
) -> Result<Unit, Problem> {
    match wanted {
        Some(wanted) if wanted.dimension != unit.dimension => Err(problem()),
        _ => Ok(unit.clone()),
    }
}

fn mismatch(name: &str, unit: &Unit, wanted: Option<&Unit>) -> String {
    let is = wanted
        .map_or_else(String::new, |wanted| format!("{} ({wanted})", wanted.dimension.in_words()));
    format!("`{name}` is {is}, and {unit} is {}", unit.dimension.in_words())
}
