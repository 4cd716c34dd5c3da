//! Cells of statistics and their limits, the same in all tables.

use crate::report::{document::*, number};
use crate::result::{QuantityResult, StatisticResult};

/// The symbol of a quantity as the head of a row.
pub fn symbol(quantity: &QuantityResult) -> Cell {
    Cell::symbol(&super::symbol(&quantity.symbol), &quantity.title).strong()
}

/// Number of pairs and of sites: `48 / 12`.
pub fn pairs_and_n(pairs: usize, n: usize) -> Cell {
    format!("{} / {}", number::count(pairs as u64), number::count(n as u64)).into()
}

/// The limit, with the decimals of the value; `≥` before a least value.
pub fn limit(statistic: Option<&StatisticResult>) -> Cell {
    let Some(one) = statistic else { return Cell::MISSING };
    let format = Format::Fixed(decimals(one));
    if let Some((low, high)) = one.between() {
        return Cell::text(format!("{} to {}", format.print(low), format.print(high)));
    }
    let cell = Cell::number(one.limit, format);
    match one.direction.sign() {
        "" => cell,
        sign => Cell::text(format!("{sign}{}", cell.printed().letters())),
    }
}

/// Decimals of a statistic: those of its unit, or more if the limit (or else the value) needs them
/// to show two digits.
pub fn decimals(statistic: &StatisticResult) -> usize {
    number::decimals(&statistic.unit, statistic.limit.or(statistic.value))
}

/// The value with the decimals of its unit, or more if the comparison with the limit needs them.
pub fn value(statistic: Option<&StatisticResult>) -> Cell {
    statistic.map_or(Cell::MISSING, |one| {
        let decimals = decimals(one);
        let format =
            one.limit.map_or(Format::Fixed(decimals), |limit| Format::Beside { limit, decimals });
        Cell::number(one.value, format)
    })
}

/// |value| / limit with two decimals, or more close to 1, in the colour of what it came to.
pub fn normalised(statistic: Option<&StatisticResult>) -> Cell {
    let ratio = statistic.and_then(|statistic| statistic.normalised);
    Cell::number(ratio, Format::Ratio).toned(Finding::of_statistic(statistic).tone)
}

/// With the columns of a confidence interval: together on paper, each end on a screen.
pub fn intervals(table: Table, sparse: bool) -> Table {
    let columns = [
        ("95 % interval", Medium::Paper),
        ("95 % interval, low", Medium::Screen),
        ("high", Medium::Screen),
    ];
    table.each(columns, |table, (title, medium)| {
        table.number(title).only(medium).when(sparse, Table::sparse)
    })
}

/// The cells of [`intervals`].
pub fn interval(one: &StatisticResult) -> [Cell; 3] {
    let format = Format::Fixed(decimals(one));
    let ends =
        one.interval.map(|(low, high)| format!("{} to {}", format.print(low), format.print(high)));
    let [low, high] = [one.interval.map(|ends| ends.0), one.interval.map(|ends| ends.1)];
    [Cell::or_missing(ends), Cell::number(low, format), Cell::number(high, format)]
}
