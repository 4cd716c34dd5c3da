//! One quantity: its statistics and limits, its worst pairs, and all its values.

use super::{View, brief, caption, groups, in_unit, reports, spread, statistic, values};
use crate::report::{brief::in_full, document::*, estimates, figure, number, sides::Sides};
use crate::result::{PairValue, QuantityResult, StatisticResult};

/// Rows of a table that stays on one page with what a quantity is.
const KEPT: usize = 10;

/// All quantities, or of many those that do not meet their limits; none without quantities.
pub fn chapter(view: &View<'_>) -> Option<Chapter> {
    let all = &view.found.quantities;
    let mut blocks = brief::blocks(view);
    blocks.extend(in_full(all).into_iter().map(|at| Block::Part(part(at, &all[at], view))));
    (!all.is_empty()).then(|| Chapter::new("quantities", "Quantities", blocks))
}

fn part(at: usize, quantity: &QuantityResult, view: &View<'_>) -> Topic {
    let finding = Finding::of_quantity(quantity);
    let rows = if sides_apart(quantity) { "Pairs" } else { "Values" };
    let reason = quantity.reason.as_ref().map(|reason| number::raised(reason.text()));
    let reason = reason.map_or_else(String::new, |reason| format!(": {reason}"));
    let mut opening = vec![
        Block::text(Text::from(Run::Finding(finding.clone())).and(reason)),
        Block::Facts(definition(quantity, view.work)),
    ];
    if !quantity.notes.is_empty() {
        opening.push(Block::list(quantity.notes.iter().map(number::raised)));
    }
    let statistics = statistics(quantity, rows);
    let (mut on_paper, mut on_screen) = (Vec::new(), Vec::new());
    if !statistics.rows.is_empty() {
        // More than a handful of rows may break over pages.
        let whole = statistics.rows.len() <= KEPT;
        on_screen.push(statistics.clone().into());
        if whole { &mut opening } else { &mut on_paper }.push(Block::on_paper([statistics.into()]));
    }
    let mut blocks = on_paper;
    if !quantity.values.is_empty() {
        blocks.push(pairs(at, quantity).into());
    }
    if figure::has_frequency(quantity) {
        blocks.push(frequency(at, quantity).into());
    }
    blocks.push(Block::on_screen(on_screen));
    blocks.extend(spread::tables(quantity).into_iter().map(Block::from));
    blocks.extend(groups::tables(quantity, rows).into_iter().map(Block::from));
    let further = caption("Further estimates of ", quantity);
    let further = further.and(in_unit(quantity)).and(", without limits");
    blocks.extend(reports::tables(&quantity.reported, &further, rows));
    blocks.extend(regressions(at, quantity).into_iter().map(Block::from));
    blocks.extend(values::worst(quantity).map(Block::from));
    blocks.push(values::all(quantity));
    let title = quantity.title.clone();
    Topic {
        id: format!("quantity-{at}"),
        title,
        short: caption("", quantity),
        finding,
        opening,
        blocks,
    }
}

/// What it is and where the protocol defines it.
fn definition(quantity: &QuantityResult, work: Option<&str>) -> Vec<Vec<Fact>> {
    let symbol = Text::symbol(&super::symbol(&quantity.symbol))
        .and(" (")
        .then(Run::Code(quantity.id.clone()))
        .and(format!("), unit {}", number::unit(&quantity.unit)));
    let source = quantity.source.as_deref().map(|source| super::with_work(source, work));
    let comparison = if quantity.from.is_some() { "Assessed" } else { "Comparison" };
    vec![
        facts([
            ("Quantity", symbol),
            ("Signals", (&quantity.of).into()),
            ("Filter", (&quantity.filter).into()),
            ("Processing", (&quantity.processing).into()),
        ]),
        facts([
            (comparison, number::formula(&quantity.comparison).into()),
            ("Clause", (&quantity.clause).into()),
            ("Source", (&source).into()),
            ("Rule", format!("{}, line {}", quantity.rule.file, quantity.rule.line).into()),
        ]),
    ]
}

/// Whether its values are of a simulated and a measured record.
fn sides_apart(quantity: &QuantityResult) -> bool {
    quantity.from.is_none() && quantity.among.is_none() && !quantity.repeats
}

/// Results that have no table of their own.
fn stated(quantity: &QuantityResult) -> Vec<&StatisticResult> {
    let by_group: Vec<_> =
        estimates::condensed(quantity).into_iter().filter(estimates::OfLimit::by_group).collect();
    estimates::others(quantity, &by_group)
}

fn statistics(quantity: &QuantityResult, rows: &str) -> Table {
    let row = |one: &StatisticResult| {
        let (title, unit) = (number::formula(&one.title), number::unit(&one.unit));
        let with_unit = if unit == number::NONE { String::new() } else { format!(", {unit}") };
        let mut cells = vec![
            Cell::from(format!("{title}{with_unit}")),
            title.into(),
            unit.into(),
            Cell::formula(one.scope.to_string()),
            statistic::pairs_and_n(one.count, one.n),
            statistic::value(Some(one)),
        ];
        cells.extend(statistic::interval(one));
        cells.extend([
            statistic::limit(Some(one)),
            Cell::formula(&one.limit_printed),
            statistic::normalised(Some(one)),
        ]);
        Row::from(cells).ending(Finding::of_statistic(Some(one)), one.reason.as_ref())
    };
    let caption = caption("Statistics of ", quantity).and(" against their limits");
    let table = Table::new(caption)
        .text("Statistic")
        .wide(1.5)
        .only(Medium::Paper)
        .text("Statistic")
        .only(Medium::Screen)
        .names_row(true)
        .short("Unit")
        .only(Medium::Screen)
        .name("Scope")
        .number(format!("{rows} / n"))
        .number("Value");
    statistic::intervals(table, false)
        .number("Limit")
        .text("Limit as worded")
        .wide(1.2)
        .number("|Value| / limit")
        .short("Finding")
        .rows(stated(quantity).into_iter().map(row))
        .size(8.0)
}

fn pairs(at: usize, quantity: &QuantityResult) -> Figure {
    let shown = estimates::representatives(quantity);
    let found: Vec<String> = shown
        .into_iter()
        .map(|one| {
            format!(
                "{} ({}) {}, limit {}",
                one.title,
                one.scope,
                statistic::value(Some(one)).printed().letters(),
                statistic::limit(Some(one)).printed().letters()
            )
        })
        .collect();
    let what = match (quantity.has_sides, &quantity.from) {
        (true, _) => format!("{}, and their differences", Sides::of(quantity).against()),
        (false, Some(side)) => format!("{side} values by section with their limits"),
        (false, None) => "values of the comparison".to_owned(),
    };
    let rows = if sides_apart(quantity) { "pairs" } else { "values" };
    let count = number::count(quantity.values.len() as u64);
    let caption = self::caption("", quantity).and(format!(": {what}, {count} {rows}"));
    let alt = format!(
        "{}: {what} of {} {rows} in {}. {}.",
        quantity.title,
        quantity.values.len(),
        number::unit(&quantity.unit),
        found.join("; ")
    );
    Figure::new(format!("pairs-{at}"), caption, alt, 100)
}

fn regressions(at: usize, quantity: &QuantityResult) -> Vec<Figure> {
    let limits = estimates::limits(quantity);
    let of = |(nth, limit): (usize, &estimates::OfLimit<'_>)| {
        let drawn = figure::drawn(limit);
        let (first, regression) = *drawn.first()?;
        let all = limit.results.len();
        let missing = limit.results.iter().filter(|one| one.regression.is_none()).count();
        let mut some = match (drawn.len(), all) {
            (1, 1) => String::new(),
            (drawn, all) if drawn == all => format!(", {all} groups"),
            (drawn, _) => format!(", {drawn} of {all} groups"),
        };
        if drawn.len() + missing < all {
            some.push_str(" with the largest ratios");
        }
        if missing > 0 {
            some.push_str(&format!("; {missing} have no regression"));
        }
        let title = number::formula(&first.title);
        let says = format!(": {title}, values over {}{some}", regression.regressor);
        let alt = format!(
            "{}: values, regression{} and limit over {} for {} groups. The numbers are in the table of the estimate.",
            quantity.title,
            regression.bound.as_ref().map_or_else(String::new, |bound| format!(", {bound}")),
            regression.regressor,
            drawn.len()
        );
        Some(Figure::new(
            format!("regression-{at}-{nth}"),
            caption("", quantity).and(says),
            alt,
            190,
        ))
    };
    limits.iter().enumerate().filter_map(of).collect()
}

fn frequency(at: usize, quantity: &QuantityResult) -> Figure {
    let some = |of: fn(&PairValue) -> bool| quantity.values.iter().any(of);
    let by = match (some(|value| value.record.is_some()), some(|value| value.zone.is_some())) {
        (true, _) => " by record",
        (false, true) => " by zone",
        (false, false) => "",
    };
    let says = format!(": cumulative frequency of the values{by}, with the limits");
    let alt = format!(
        "{}: cumulative frequency of {} values in {}{by}. The values are in the table of all values.",
        quantity.title,
        quantity.values.len(),
        number::unit(&quantity.unit)
    );
    Figure::new(format!("frequency-{at}"), caption("", quantity).and(says), alt, 90)
}
