//! What is wrong with the header of a record, told once for all columns that have it.

use std::{io::BufRead, path::Path};

use super::Wanted;
use crate::data::{
    cells::{self, Heading},
    prelude::*,
    text::open_text,
};
use crate::problem::nearest;

/// One problem for all columns with the same fault: the header is shown once.
pub fn alike(wrong: Vec<(&Heading, Problem)>) -> Vec<Problem> {
    let unit = |heading: &Heading| heading.unit.as_ref().map(|unit| unit.text.clone());
    let mut groups: Vec<(&Heading, Problem, Vec<String>)> = Vec::new();
    for (heading, problem) in wrong {
        let same = groups
            .iter_mut()
            .find(|(first, told, _)| told.code == problem.code && unit(first) == unit(heading));
        match same {
            Some((.., others)) => others.push(format!("`{}`", heading.name)),
            None => groups.push((heading, problem, Vec::new())),
        }
    }
    let told = |(_, mut problem, others): (&Heading, Problem, Vec<String>)| {
        if !others.is_empty() {
            problem.says += &format!("; the same of {}", others.join(", "));
        }
        problem
    };
    groups.into_iter().map(told).collect()
}

/// The header once more between the rows: files that were put one behind another.
pub fn repeated(path: &Path, shown: &str) -> Option<Problem> {
    let mut lines = open_text(path, shown).ok()?.lines().map_while(Result::ok).enumerate();
    let (_, first) = lines.next()?;
    let header = first.strip_prefix('\u{feff}').unwrap_or(&first).trim_end();
    let mut lines = lines.filter(|(_, line)| line.trim_end() == header);
    let (at, line) = lines.next()?;
    let more = match lines.count() {
        0 => String::new(),
        1 => ", and once more".to_string(),
        more => format!(", and {more} times more"),
    };
    let problem = problem!(
        "header-repeated",
        &Source::excerpt(shown, line.trim_end(), at + 1).whole(),
        "the header stands between the rows again, in line {}{more}",
        at + 1
    );
    Some(problem.help("one file holds one record: give each its own file and section"))
}

/// Units that stand in the first row or in cells of their own.
pub fn units_elsewhere(row: &str, headings: &[Heading], shown: &str) -> Option<Problem> {
    units_in_row(row, headings, shown).or_else(|| cells::unit_in_cell(headings))
}

/// Units in a row of their own below the names, which no heading has.
fn units_in_row(line: &str, headings: &[Heading], shown: &str) -> Option<Problem> {
    if headings.iter().any(|heading| heading.unit.is_some()) {
        return None;
    }
    let cells = cells::split(line).ok()?;
    let unit = |text: &str| Unit::parse(text.trim_matches(['[', ']', '(', ')'])).is_ok();
    if cells.len() != headings.len()
        || !cells.iter().all(|cell| unit(&cell.text) && cell.text.parse::<f64>().is_err())
    {
        return None;
    }
    let (name, unit) =
        (&headings.first()?.name, cells.first()?.text.trim_matches(['[', ']', '(', ')']));
    Some(
        error(
            "units-in-row",
            "the units stand in a row of their own",
            &Source::excerpt(shown, line, 2).whole(),
        )
        .help(format!("write each unit behind its name, in one header line: `{name} [{unit}]`")),
    )
}

/// `Y_1R (kN)`, `Y_1R_kN`, `Y_1R/kN` for a column `Y_1R`: the unit.
fn unit_otherwise<'a>(heading: &'a str, name: &str) -> Option<&'a str> {
    let rest = heading.strip_prefix(name)?;
    let unit = rest.trim_matches(|c: char| c.is_whitespace() || "()<>{}_/-,".contains(c));
    (unit.len() < rest.len() && !unit.is_empty() && Unit::parse(unit).is_ok()).then_some(unit)
}

/// One problem for all columns that the header lacks: it is shown once. A column that is wanted
/// itself is not what was meant by another.
pub fn missing(headings: &[Heading], names: &[&str], wanted: &[Wanted], shown: &str) -> Problem {
    let stranger =
        |name: &&str| !name.is_empty() && !wanted.iter().any(|wanted| wanted.name == *name);
    let known = || headings.iter().map(|heading| heading.name.as_str()).filter(stranger);
    // A heading that has the unit of a wanted column written otherwise.
    let otherwise =
        |name: &str| known().find_map(|heading| Some((heading, unit_otherwise(heading, name)?)));
    let lacks = |which: String| problem!("unknown-channel", "`{shown}` has no {which}");
    let problem = if let [name] = names {
        let problem = lacks(format!("column `{name}`"));
        match otherwise(name) {
            Some((heading, unit)) => problem.help(format!(
                "the unit of `{heading}` goes into square brackets: `{name} [{unit}]`"
            )),
            None => problem.suggest(name, known()),
        }
    } else {
        let list: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
        let slip = |name: &&str| match otherwise(name) {
            Some((heading, unit)) => Some(format!("`{name} [{unit}]` for `{heading}`")),
            None => Some(format!("`{}` for `{name}`", nearest(name, known())?)),
        };
        let slips: Vec<String> = names.iter().filter_map(slip).collect();
        let help = (!slips.is_empty()).then(|| format!("did you mean {}?", slips.join(", ")));
        lacks(format!("columns {}", list.join(", "))).help_if(help)
    };
    match (headings.first(), headings.last()) {
        (Some(first), Some(last)) => problem.at(&first.span.to(&last.span)),
        _ => problem,
    }
}
