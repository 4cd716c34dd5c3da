//! Estimates by group: one row for each limit in the summary, one table for each limit with its
//! groups.

use super::{View, caption, name, statistic};
use crate::report::{
    document::*,
    estimates::{self, OfLimit},
    number,
    sides::capital,
};
use crate::result::{QuantityResult, StatisticResult};

/// The condensed limits of all quantities, each with the group that is nearest to it or farthest
/// beyond.
pub fn summary(view: &View<'_>) -> Table {
    let limits = view.found.quantities.iter().flat_map(|quantity| {
        let row = move |limit: OfLimit<'_>| row(quantity, &limit);
        estimates::condensed(quantity).into_iter().map(row).collect::<Vec<_>>()
    });
    let caption =
        "Estimates and their limits: how many groups hold, and the group with the largest ratio";
    Table::new(caption)
        .short("Quantity")
        .text("Estimate")
        .wide(1.5)
        .short("Groups met")
        .short("Unit")
        .number("Values / n")
        .only(Medium::Screen)
        .numbers(["Largest", "Limit", "|Value| / limit"])
        .text("Where")
        .wide(1.2)
        .short("Criterion")
        .rows(limits)
        .size(7.5)
}

/// The values of the decisive group; the finding is that of all.
fn row(quantity: &QuantityResult, limit: &OfLimit<'_>) -> Row {
    let decisive = limit.decisive();
    let marginal = limit.holds().is_some() && limit.results.iter().any(|one| one.marginal);
    let finding = Finding::of(limit.holds()).marginal(marginal);
    let place = decisive.value.map(|_| decisive.scope.to_string());
    Row::from(cells![
        statistic::symbol(quantity),
        Cell::formula(&decisive.title),
        limit.holding(),
        number::unit(&decisive.unit),
        statistic::pairs_and_n(decisive.count, decisive.n),
        statistic::value(Some(decisive)),
        statistic::limit(Some(decisive)),
        statistic::normalised(Some(decisive)).toned(finding.tone),
        Cell::or_missing(place)
    ])
    .ending(finding, limit.reason())
}

/// A table for each condensed limit that has several groups; `rows` is what the values are called.
pub fn tables(quantity: &QuantityResult, rows: &str) -> Vec<Table> {
    let limits = estimates::condensed(quantity);
    limits.iter().filter(|limit| limit.by_group()).map(|one| table(quantity, one, rows)).collect()
}

fn table(quantity: &QuantityResult, limit: &OfLimit<'_>, rows: &str) -> Table {
    let first = limit.results[0];
    let keys = heads(limit);
    let decimals =
        number::decimals(&quantity.unit, limit.results.iter().filter_map(|one| one.sample.mean));
    let row = |one: &&StatisticResult| {
        let mut cells: Vec<Cell> = members(one, &keys).into_iter().map(Cell::from).collect();
        cells.push(statistic::pairs_and_n(one.count, one.n));
        cells.push(Cell::number(one.sample.mean, Format::Fixed(decimals)));
        cells.push(Cell::number(one.sample.std, Format::Fixed(decimals)));
        cells.push(statistic::value(Some(one)).strong());
        cells.extend(statistic::interval(one));
        cells.push(statistic::limit(Some(one)));
        cells.push(statistic::normalised(Some(one)));
        Row::from(cells).ending(Finding::of_statistic(Some(one)), one.reason.as_ref())
    };
    let caption = caption(&format!("{} of ", number::formula(&first.title)), quantity)
        .and(format!(", limit {}", number::formula(&first.limit_printed)));
    let table = Table::new(caption)
        .each(&keys, |table, key| table.name(capital(key)).names_row(false))
        .number(format!("{rows} / n"))
        .each(["Mean", "s"], |table, title| table.number(title).unit(&quantity.unit))
        .number("Estimate")
        .unit(&first.unit);
    statistic::intervals(table, true)
        .number("Limit")
        .unit(&first.unit)
        .number("|Value| / limit")
        .text("Finding")
        .wide(1.0)
        .rows(limit.results.iter().map(row))
        .size(8.0)
}

/// Head of a column with the whole scope.
const GROUP: &str = "group";

/// What tells the groups of a limit apart.
fn heads(limit: &OfLimit<'_>) -> Vec<String> {
    let heads = |one: &StatisticResult| {
        one.scope.members().iter().map(|(key, _)| (*key).to_owned()).collect::<Vec<_>>()
    };
    let first = heads(limit.results[0]);
    let alike = !first.is_empty() && limit.results.iter().all(|one| heads(one) == first);
    if alike { first } else { vec![GROUP.into()] }
}

fn members(one: &StatisticResult, heads: &[String]) -> Vec<String> {
    if heads == [GROUP] {
        return vec![name(&one.scope.to_string())];
    }
    one.scope.members().iter().map(|(_, member)| name(member)).collect()
}
