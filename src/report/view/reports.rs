//! Estimates without a limit as tables: groups are rows, estimates are columns.

use indexmap::{IndexMap, IndexSet};
use serde::Serialize;

use super::{ColumnHead, name};
use crate::report::number;
use crate::report::sides::capital;
use crate::result::Reported;

/// Number of estimates side by side that fit a page.
const ABREAST: usize = 6;
/// Head of the first column where rows are no groups of keys.
const GROUP: &str = "group";

/// Estimates of the same groups.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ReportTable {
    /// `Zone`, `Wheelset`
    pub keys: Vec<String>,
    pub columns: Vec<ColumnHead>,
    pub rows: Vec<ReportRow>,
    /// Why numbers are missing.
    pub reasons: Vec<String>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ReportRow {
    /// The member of each key.
    pub of: Vec<String>,
    /// Values or sections of the estimates in the row: `12`, `9 to 12`.
    pub count: String,
    pub values: Vec<String>,
}

pub(super) fn tables(reported: &[Reported]) -> Vec<ReportTable> {
    let mut by_keys: IndexMap<Vec<&str>, Vec<&Reported>> = IndexMap::new();
    for one in reported {
        by_keys.entry(keys(one)).or_default().push(one);
    }
    let abreast = |(keys, all): (Vec<&str>, Vec<&Reported>)| {
        let columns: IndexSet<Column<'_>> = all.iter().map(|one| column(one)).collect();
        let columns: Vec<Column<'_>> = columns.into_iter().collect();
        columns.chunks(ABREAST).map(|columns| table(&keys, columns, &all)).collect::<Vec<_>>()
    };
    by_keys.into_iter().flat_map(abreast).collect()
}

/// Estimate, condition and unit.
type Column<'a> = (&'a str, Option<&'a str>, &'a str);

fn column(one: &Reported) -> Column<'_> {
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

fn table(keys: &[&str], columns: &[Column<'_>], all: &[&Reported]) -> ReportTable {
    let mut rows: IndexMap<Vec<String>, Vec<&Reported>> = IndexMap::new();
    for one in all.iter().filter(|one| columns.contains(&column(one))) {
        rows.entry(members(one)).or_default().push(one);
    }
    let of = |wanted: &Column<'_>| {
        all.iter()
            .filter(|one| column(one) == *wanted)
            .filter_map(|one| one.value)
            .collect::<Vec<_>>()
    };
    let decimals: Vec<usize> =
        columns.iter().map(|wanted| number::decimals(wanted.2, of(wanted))).collect();
    let cell = |cells: &[&Reported], (wanted, decimals): (&Column<'_>, &usize)| {
        let value = cells.iter().find(|one| column(one) == *wanted).and_then(|one| one.value);
        number::optional(value, *decimals)
    };
    let head = |(title, condition, unit): &Column<'_>| {
        let title = capital(&number::formula(title));
        let title = condition.map_or_else(
            || title.clone(),
            |condition| format!("{title}, {}", number::formula(condition)),
        );
        ColumnHead { title, unit: number::unit(unit), numeric: true }
    };
    let reason = |one: &&Reported| {
        one.reason.as_ref().map(|reason| {
            number::raised(&format!(
                "{}, {}: {reason}",
                capital(&number::formula(&one.title)),
                one.scope
            ))
        })
    };
    ReportTable {
        keys: keys.iter().map(|key| capital(key)).collect(),
        columns: columns.iter().map(head).collect(),
        reasons: rows.values().flatten().filter_map(reason).collect(),
        rows: rows
            .iter()
            .map(|(members, cells)| ReportRow {
                of: members.iter().map(|member| name(member)).collect(),
                count: count(cells),
                values: columns.iter().zip(&decimals).map(|column| cell(cells, column)).collect(),
            })
            .collect(),
    }
}

fn count(cells: &[&Reported]) -> String {
    let counts = || cells.iter().map(|one| one.count.number() as u64);
    match (counts().min().unwrap_or_default(), counts().max().unwrap_or_default()) {
        (low, high) if low == high => number::count(high),
        (low, high) => format!("{} to {}", number::count(low), number::count(high)),
    }
}
