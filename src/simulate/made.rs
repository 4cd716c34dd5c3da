//! The record that a simulator made, as a program or as a function.

use super::campaign::{Units, in_units, signals_of};
use crate::data::{Heading, record::RecordSource};
use crate::effects::Signals;
use crate::problem::Problem;
use crate::units::Unit;

/// Reads and checks a record that was made, in the units of the campaign's simulation, whose
/// headings are `known`. `channels` are those that it must have; without any, it needs those of the
/// campaign's simulation. Also the units that it was made in.
///
/// # Errors
/// Of reading; `unknown-channel`, `unit-mismatch`; `not-increasing`: of the position.
pub fn read_made(
    made: &RecordSource,
    known: &[Heading],
    channels: &[String],
) -> Result<(Signals, Units), Problem> {
    let shown = made.inside();
    let headings = made.headings().map_err(first)?;
    let wanted = wanted(known, channels);
    for &name in &wanted {
        let names: Vec<&str> = headings.iter().map(|one| one.name.as_str()).collect();
        let Some(heading) = headings.iter().find(|one| one.name == name) else {
            return Err(lacks(shown, name, &names, &wanted));
        };
        heading.unit(unit_in(known, name).map(|unit| unit.dimension))?;
    }
    let (mut signals, units) = signals_of(made).map_err(first)?;
    if let Some(at) = signals.axis.windows(2).position(|pair| pair[1] <= pair[0]) {
        return Err(Problem::error(
            "not-increasing",
            format!("{shown}: the position does not increase in line {}", at + 3),
        ));
    }
    in_units(&mut signals, &units, &|name| unit_in(known, name))?;
    Ok((signals, units))
}

/// The channels that a record must have; without any that are asked for, those of the campaign's
/// simulation.
pub fn wanted<'a>(known: &'a [Heading], asked: &'a [String]) -> Vec<&'a str> {
    if asked.is_empty() {
        known.iter().map(|heading| heading.name.as_str()).collect()
    } else {
        asked.iter().map(String::as_str).collect()
    }
}

/// A record without a column that is wanted, with the nearest of the columns that nobody wants.
pub fn lacks(shown: &str, name: &str, made: &[&str], wanted: &[&str]) -> Problem {
    let strangers = made.iter().copied().filter(|one| !wanted.contains(one));
    Problem::error("unknown-channel", format!("{shown} has no column `{name}`"))
        .suggest(name, strangers)
}

/// The unit of a column.
pub fn unit_in(headings: &[Heading], name: &str) -> Option<Unit> {
    headings.iter().find(|heading| heading.name == name)?.unit(None).ok()
}

/// The first of some problems, where one is told.
pub fn first(problems: Vec<Problem>) -> Problem {
    problems
        .into_iter()
        .next()
        .unwrap_or_else(|| Problem::error("unreadable", "the file cannot be read"))
}
