//! The values of a quantity: the worst, and all.

use std::collections::{HashMap, HashSet};

use indexmap::IndexMap;

use super::{caption, in_unit, name};
use crate::report::{document::*, number, sides::Sides};
use crate::result::{Direction, PairValue, QuantityResult, RecordName};

/// Number of worst pairs listed.
const WORST: usize = 5;
/// Number of signals side by side that fit a page, with and without simulated and measured values.
const SIGNALS_WITH_SIDES: usize = 4;
const SIGNALS_WITHOUT_SIDES: usize = 10;
/// Of these, signals of a table that may stand in two halves, and its rows on a page.
const HALF_WITH_SIDES: usize = 2;
const HALF_WITHOUT_SIDES: usize = 4;
const ROWS: usize = 50;
/// Rows of a table that stays on one page.
const KEPT_WITH_SIDES: usize = 8;
const KEPT_WITHOUT_SIDES: usize = 16;
/// Letters of a name that are not broken beside many numbers.
const UNBROKEN: usize = 7;

/// All values are printed with the same decimals.
fn format(quantity: &QuantityResult) -> Format {
    let sizes = |pair: &PairValue| [Some(pair.difference), pair.simulated, pair.measured];
    let all = quantity.values.iter().flat_map(sizes).flatten();
    Format::Fixed(number::decimals(&quantity.unit, all))
}

/// The pairs that use the largest shares of their limits; without limits, the largest ones.
pub fn worst(quantity: &QuantityResult) -> Option<Table> {
    let own = quantity.values.iter().any(|pair| pair.limit.is_some());
    let yardstick = quantity.yardstick().filter(|_| !own);
    let format = format(quantity);
    let row = |(pair, ratio): &(&PairValue, Option<f64>)| {
        let mut cells = vec![
            Cell::from(name(&pair.section)),
            pair.record.as_ref().map(shortened).into(),
            (&pair.zone.as_deref().map(name)).into(),
            name(&pair.signal).into(),
        ];
        if quantity.has_sides {
            cells.extend([pair.simulated, pair.measured].map(|value| Cell::number(value, format)));
        }
        cells.push(Cell::number(pair.difference, format).strong());
        cells.extend(own.then(|| Cell::number(pair.limit, format)));
        let ratio = Cell::number(*ratio, Format::Fixed(2));
        cells.extend((own || yardstick.is_some()).then_some(ratio));
        cells.push((pair.samples as u64).into());
        Row::from(cells).in_zone(pair.zone.as_deref().map(name).as_deref())
    };
    let what = if quantity.has_sides { "differences" } else { "values" };
    let against = match yardstick {
        _ if own => ", and divided by its own limit".into(),
        Some((one, _)) => format!(", and divided by the limit of the {}", one.title),
        None => String::new(),
    };
    let lower = yardstick.is_some_and(|(one, _)| one.direction == Direction::AtLeast);
    let which = if own || lower { "Decisive" } else { "Largest" };
    let caption =
        self::caption(&format!("{which} {what} of "), quantity).and(in_unit(quantity)).and(against);
    let pairs = quantity.worst_first();
    let table = Table::new(caption)
        .name("Section")
        .wide(1.4)
        .breaks(24)
        .name("Record")
        .breaks(24)
        .sparse()
        .name("Zone")
        .sparse()
        .name("Signal")
        .wide(1.0)
        .breaks(20)
        .when(quantity.has_sides, |table| table.numbers(Sides::of(quantity).heads()))
        .number(if quantity.has_sides { "Difference" } else { "Value" })
        .when(own, |table| table.number("Limit"))
        .when(own || yardstick.is_some(), |table| table.number("|Value| / limit"))
        .number("Samples");
    let rows = pairs.iter().take(WORST).map(row);
    (!pairs.is_empty()).then(|| table.rows(rows).size(8.0))
}

/// All values, as a block that a screen folds.
pub fn all(quantity: &QuantityResult) -> Block {
    if quantity.values.is_empty() {
        return Block::text("No values could be formed.");
    }
    let count = number::count(quantity.values.len() as u64);
    let line = caption(&format!("All {count} values of "), quantity).and(in_unit(quantity));
    Block::Details(line, tables(quantity).into_iter().map(Block::from).collect())
}

/// A row of values: a section, a record of it, and which of several values of one position.
type ValueRow<'a> = (&'a str, Option<&'a RecordName>, usize);
/// The name of a record, shortened for a table.
fn shortened(record: &RecordName) -> String {
    name(&record.to_string())
}

/// Values by their signals.
type BySignal<'a> = HashMap<&'a str, &'a PairValue>;

/// Sections and their records as rows, signals as columns, both in order of first occurrence. A
/// position with several values of one record, which have a rule each, has several rows.
fn tables(quantity: &QuantityResult) -> Vec<Table> {
    let signals = first_seen(quantity.values.iter().map(|pair| pair.signal.as_str()));
    let width = if quantity.has_sides { SIGNALS_WITH_SIDES } else { SIGNALS_WITHOUT_SIDES };
    let mut rows: IndexMap<ValueRow<'_>, BySignal<'_>> = IndexMap::new();
    let mut seen: HashMap<(&str, Option<&RecordName>, &str), usize> = HashMap::new();
    for pair in &quantity.values {
        let (section, record) = (pair.section.as_str(), pair.record.as_ref());
        let nth = seen.entry((section, record, &pair.signal)).or_default();
        rows.entry((section, record, *nth)).or_default().insert(&pair.signal, pair);
        *nth += 1;
    }
    // Rows of one section stay together.
    rows.sort_by_cached_key(|(section, ..), _| {
        quantity.values.iter().position(|pair| pair.section == **section)
    });
    let sections = |signal: &str| -> HashSet<&str> {
        let with = quantity.values.iter().filter(|pair| pair.signal == signal);
        with.map(|pair| pair.section.as_str()).collect()
    };
    // Signals without a common section are not of one table: half of it would be empty.
    signals
        .chunk_by(|one, next| !sections(one).is_disjoint(&sections(next)))
        .flat_map(|signals| signals.chunks(width))
        .map(|signals| table(quantity, signals, &rows))
        .collect()
}

/// Values of up to four signals (ten without sides).
fn table(
    quantity: &QuantityResult,
    signals: &[&str],
    rows: &IndexMap<ValueRow<'_>, BySignal<'_>>,
) -> Table {
    let (sides, format) = (Sides::of(quantity), format(quantity));
    let row = |((section, record, _), pairs): (&ValueRow<'_>, &BySignal<'_>)| {
        let zone = pairs.values().next().and_then(|pair| pair.zone.as_deref()).map(name);
        let mut cells =
            vec![Cell::from(name(section)), record.map(shortened).into(), (&zone).into()];
        for signal in signals {
            let pair = pairs.get(signal);
            if quantity.has_sides {
                let sides =
                    [pair.and_then(|pair| pair.simulated), pair.and_then(|pair| pair.measured)];
                cells.extend(sides.map(|value| Cell::number(value, format)));
            }
            cells.push(Cell::number(pair.map(|pair| pair.difference), format));
        }
        Row::from(cells).in_zone(zone.as_deref())
    };
    let heads = [sides.short[0], sides.short[1], "diff."];
    let of_signal = |table: Table, signal: &&str| match quantity.has_sides {
        true => table.each(heads, |table, head| table.number(head).wide(1.0).under(name(signal))),
        false => table.number(name(signal)).wide(1.0).breaks(UNBROKEN),
    };
    let what = if quantity.has_sides {
        format!(": {}, difference", sides.heads().join(", ").to_lowercase())
    } else {
        String::new()
    };
    let caption = self::caption("All values of ", quantity).and(in_unit(quantity)).and(what);
    let rows = rows.iter().filter(|(_, pairs)| signals.iter().any(|one| pairs.contains_key(one)));
    let half = if quantity.has_sides { HALF_WITH_SIDES } else { HALF_WITHOUT_SIDES };
    let table = Table::new(caption)
        .name("Section")
        .wide(1.2)
        .breaks(UNBROKEN)
        .name("Record")
        .breaks(14)
        .sparse()
        .name("Zone")
        .breaks(3)
        .sparse()
        .each(signals, of_signal)
        .rows(rows.map(row))
        .class("sortable values")
        .size(7.5)
        .kept(if quantity.has_sides { KEPT_WITH_SIDES } else { KEPT_WITHOUT_SIDES });
    if signals.len() <= half { table.abreast(ROWS) } else { table }
}

/// Unique names in order of first occurrence.
fn first_seen<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut seen = indexmap::IndexSet::new();
    seen.extend(names);
    seen.into_iter().collect()
}
