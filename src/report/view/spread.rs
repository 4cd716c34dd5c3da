//! How far several records of one side are apart, as tables: a column for each record, a block of
//! rows for each class of sections.

use super::{caption, in_unit, name};
use crate::report::{document::*, number};
use crate::result::{ClassSpread, Furthest, OfRecord, QuantityResult, Spread};

/// Number of records side by side that fit a page.
const RECORDS: usize = 6;

/// A table; several where there are more records than fit a page.
pub fn tables(quantity: &QuantityResult) -> Vec<Table> {
    let Some(spread) = &quantity.spread else { return Vec::new() };
    let between = between(quantity);
    let most = spread.classes.iter().map(|class| class.records.len()).max().unwrap_or(0);
    let format = Format::Fixed(decimals(quantity, spread));
    let table = |from: usize| {
        let records = spread.classes.last().map_or(&[][..], |class| part(class, from));
        let head = |table: Table, one: &OfRecord| {
            table.number(name(&one.record)).wide(1.0).breaks(UNBROKEN)
        };
        let class = |class| rows(class, part(class, from), between, format);
        let rows: Vec<Row> = spread.classes.iter().flat_map(class).collect();
        let caption = self::caption(&format!("Spread of the {between} in "), quantity)
            .and(in_unit(quantity))
            .and(format!(": deviations from the {} of all {between}", spread.center));
        Table::new(caption)
            .short("Sections")
            .short("")
            .each(records, head)
            .number(format!("Max. − min. of the {between}"))
            .number(format!("s of the {between}"))
            .rows(rows)
            .class("spread")
            .size(7.5)
    };
    (0..most).step_by(RECORDS).map(table).collect()
}

/// Letters of a word that is not broken in a column of a record.
const UNBROKEN: usize = 10;

/// What the records of a side are called where there are several.
pub fn between(quantity: &QuantityResult) -> &'static str {
    if quantity.among.as_deref() == Some("simulated") { "codes" } else { "runs" }
}

fn part(class: &ClassSpread, from: usize) -> &[OfRecord] {
    class.records.get(from..class.records.len().min(from + RECORDS)).unwrap_or_default()
}

fn decimals(quantity: &QuantityResult, spread: &Spread) -> usize {
    number::decimals(
        &quantity.unit,
        spread.classes.iter().flat_map(|class| &class.records).map(|one| one.rms),
    )
}

/// The rows of a class of sections, under its title.
fn rows(class: &ClassSpread, records: &[OfRecord], between: &str, format: Format) -> Vec<Row> {
    let shown = |value: f64| Cell::number(value, format);
    let place = |at: &Furthest| Cell::text(format!("{}, {}", name(&at.section), name(&at.signal)));
    let row = |title: &str, cell: &dyn Fn(&OfRecord) -> Cell| {
        let mut row = vec![Cell::text(title)];
        row.extend(records.iter().map(cell));
        row.extend([Cell::BLANK, Cell::BLANK]);
        row
    };
    // A row about all records: where they are farthest apart.
    let all = |title: &str, place: Cell, range: f64, std: f64| {
        let title = Cell::text(format!("Spread of the {between}, {title}"));
        vec![title, place.across(records.len()), shown(range), shown(std)]
    };
    let mut mean = row("Mean deviation", &|one| shown(one.mean));
    mean.truncate(mean.len() - 2);
    mean.extend([shown(class.range_of_means), shown(class.std_of_means)]);
    let mut rows = vec![
        mean,
        row("Standard deviation", &|one| Cell::number(one.std, format)),
        row("Largest deviation", &|one| shown(one.largest.value)),
        row("Where", &|one| place(&one.largest)),
        row("Root mean square", &|one| shown(one.rms)),
        row("Rank", &|one| Cell::from(one.rank.to_string()).strong()),
        all("mean", Cell::BLANK, class.mean_range, class.mean_std),
        all("largest", place(&class.widest), class.widest.value, class.std_at_widest),
    ];
    let title = class.zone.as_ref().map(|zone| name(&format!("Zone {zone}")));
    let title = Cell::from(title.unwrap_or_else(|| "All".into())).strong().down(rows.len());
    rows[0].insert(0, title);
    rows.into_iter().map(Row::from).collect()
}
