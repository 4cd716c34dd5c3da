//! How far several records of one side are apart, as tables: a column for each record, a block of
//! rows for each class of sections.

use serde::Serialize;

use super::name;
use crate::report::number;
use crate::result::{ClassSpread, Furthest, OfRecord, QuantityResult, Spread};

/// Number of records side by side that fit a page.
const RECORDS: usize = 6;

/// A table; several where there are more records than fit a page.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SpreadTable {
    /// `codes`, `runs`
    pub between: &'static str,
    /// `mean`, `median`
    pub center: String,
    pub records: Vec<String>,
    pub classes: Vec<SpreadClass>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SpreadClass {
    /// `Zone 1`, `All`
    pub title: String,
    pub rows: Vec<SpreadRow>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SpreadRow {
    pub title: String,
    /// One for each record; none of a row about all of them.
    pub cells: Vec<String>,
    /// In place of cells: where the records are farthest apart.
    pub place: Option<String>,
    /// Cells are words, numbers otherwise.
    pub words: bool,
    /// Between the records: largest less smallest, and standard deviation; empty where a row has
    /// none.
    pub range: String,
    pub std: String,
}

pub(super) fn tables(quantity: &QuantityResult) -> Vec<SpreadTable> {
    let Some(spread) = &quantity.spread else { return Vec::new() };
    let between = between(quantity);
    let decimals = decimals(quantity, spread);
    let most = spread.classes.iter().map(|class| class.records.len()).max().unwrap_or(0);
    let table = |from: usize| SpreadTable {
        between,
        center: spread.center.clone(),
        records: spread
            .classes
            .last()
            .map_or(&[][..], |class| part(class, from))
            .iter()
            .map(|one| name(&one.record))
            .collect(),
        classes: spread
            .classes
            .iter()
            .map(|class| self::class(class, part(class, from), between, decimals))
            .collect(),
    };
    (0..most).step_by(RECORDS).map(table).collect()
}

/// What the records of a side are called where there are several.
pub(super) fn between(quantity: &QuantityResult) -> &'static str {
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

fn class(class: &ClassSpread, records: &[OfRecord], between: &str, decimals: usize) -> SpreadClass {
    let shown = |value: f64| number::fixed(value, decimals);
    let place = |at: &Furthest| format!("{}, {}", name(&at.section), name(&at.signal));
    let row = |title: &str, of: &dyn Fn(&OfRecord) -> String, words: bool| SpreadRow {
        title: title.to_owned(),
        cells: records.iter().map(of).collect(),
        place: None,
        words,
        range: String::new(),
        std: String::new(),
    };
    let of_all = |title: String, place: Option<String>, range: f64, std: f64| SpreadRow {
        title,
        cells: Vec::new(),
        place: Some(place.unwrap_or_default()),
        words: true,
        range: shown(range),
        std: shown(std),
    };
    let mean = SpreadRow {
        range: shown(class.range_of_means),
        std: shown(class.std_of_means),
        ..row("Mean deviation", &|one| shown(one.mean), false)
    };
    SpreadClass {
        title: class
            .zone
            .as_ref()
            .map_or_else(|| "All".to_owned(), |zone| name(&format!("Zone {zone}"))),
        rows: vec![
            mean,
            row("Standard deviation", &|one| number::optional(one.std, decimals), false),
            row("Largest deviation", &|one| shown(one.largest.value), false),
            row("Where", &|one| place(&one.largest), true),
            row("Root mean square", &|one| shown(one.rms), false),
            row("Rank", &|one| one.rank.to_string(), false),
            of_all(
                format!("Spread of the {between}, mean"),
                None,
                class.mean_range,
                class.mean_std,
            ),
            of_all(
                format!("Spread of the {between}, largest"),
                Some(place(&class.widest)),
                class.widest.value,
                class.std_at_widest,
            ),
        ],
    }
}
