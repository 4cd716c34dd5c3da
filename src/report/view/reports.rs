//! Estimates without a limit as tables: groups are rows, estimates are columns.

use indexmap::{IndexMap, IndexSet};

use super::name;
use crate::report::{document::*, number, sides::capital};
use crate::result::Reported;

/// Number of estimates side by side that fit a page.
const ABREAST: usize = 6;
/// Head of the first column where rows are no groups of keys.
const GROUP: &str = "group";

/// Tables of all estimates, and why numbers are missing; `counted` is what they are of.
pub fn tables(reported: &[Reported], caption: &Text, counted: &str) -> Vec<Block> {
    let mut by_keys: IndexMap<Vec<&str>, Vec<&Reported>> = IndexMap::new();
    for one in reported {
        by_keys.entry(keys(one)).or_default().push(one);
    }
    let abreast = |(keys, all): (Vec<&str>, Vec<&Reported>)| {
        let columns: IndexSet<Estimate<'_>> = all.iter().map(|one| column(one)).collect();
        let columns: Vec<Estimate<'_>> = columns.into_iter().collect();
        let table = |columns: &[Estimate<'_>]| table((caption, counted), &keys, columns, &all);
        columns.chunks(ABREAST).flat_map(table).collect::<Vec<_>>()
    };
    by_keys.into_iter().flat_map(abreast).collect()
}

/// Estimate, condition and unit.
type Estimate<'a> = (&'a str, Option<&'a str>, &'a str);

fn column(one: &Reported) -> Estimate<'_> {
    (&one.title, one.condition.as_deref(), &one.unit)
}

fn keys(one: &Reported) -> Vec<&str> {
    match one.scope.members() {
        members if members.is_empty() => vec![GROUP],
        members => members.into_iter().map(|(key, _)| key).collect(),
    }
}

fn members(one: &Reported) -> Vec<String> {
    match one.scope.members() {
        members if members.is_empty() => vec![one.scope.to_string()],
        members => members.into_iter().map(|(_, member)| member.to_owned()).collect(),
    }
}

fn table(
    (caption, counted): (&Text, &str),
    keys: &[&str],
    estimates: &[Estimate<'_>],
    all: &[&Reported],
) -> Vec<Block> {
    let mut rows: IndexMap<Vec<String>, Vec<&Reported>> = IndexMap::new();
    for one in all.iter().filter(|one| estimates.contains(&column(one))) {
        rows.entry(members(one)).or_default().push(one);
    }
    let format = |wanted: &Estimate<'_>| {
        let same = all.iter().filter(|one| column(one) == *wanted);
        Format::Fixed(number::decimals(wanted.2, same.filter_map(|one| one.value)))
    };
    let formats: Vec<Format> = estimates.iter().map(format).collect();
    let row = |(members, cells): (&Vec<String>, &Vec<&Reported>)| {
        let mut row: Vec<Cell> =
            members.iter().map(|member| Cell::from(name(member)).strong()).collect();
        row.push(count(cells).into());
        row.extend(estimates.iter().zip(&formats).map(|(wanted, format)| {
            let value = cells.iter().find(|one| column(one) == *wanted).and_then(|one| one.value);
            Cell::number(value, *format)
        }));
        row
    };
    let reason = |one: &&Reported| {
        let title = capital(&number::formula(&one.title));
        let reason = one.reason.as_ref()?;
        Some(number::raised(format!("{title}, {}: {}", one.scope, reason.text())))
    };
    let head = |table: Table, (title, condition, unit): &Estimate<'_>| {
        let condition = condition.map(|condition| format!(", {}", number::formula(condition)));
        let title = capital(&number::formula(title)) + &condition.unwrap_or_default();
        table.number(title).wide(1.0).unit(unit)
    };
    let table = Table::new(caption.clone())
        .each(keys, |table, key| table.name(capital(key)).names_row(true))
        .number(counted)
        .each(estimates, head)
        .rows(rows.iter().map(row))
        .size(8.0);
    let reasons: Vec<String> = rows.values().flatten().filter_map(reason).collect();
    let reasons = (!reasons.is_empty()).then(|| Block::list(reasons));
    std::iter::once(Block::from(table)).chain(reasons).collect()
}

fn count(cells: &[&Reported]) -> String {
    let counts = || cells.iter().map(|one| one.count.number() as u64);
    match (counts().min().unwrap_or_default(), counts().max().unwrap_or_default()) {
        (low, high) if low == high => number::count(high),
        (low, high) => format!("{} to {}", number::count(low), number::count(high)),
    }
}
